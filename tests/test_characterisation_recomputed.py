"""Chapter 3's printed results: what its own data give, and the slips that show."""

from dataclasses import replace

import pytest

from bondgraph import Published
from flegx_models.characterisation.errors import CharacterisationError
from flegx_models.characterisation.recomputed import recomputed
from flegx_models.parameters import PRINTED
from flegx_models.parameters_chapter3 import CHAPTER_3

ROWS = recomputed()


def test_every_formula_as_printed_gives_the_printed_result() -> None:
    plain = [row for row in ROWS if not row.cause]
    assert len(plain) >= 20
    assert [row.quantity for row in plain if not row.agrees] == []


def test_the_correct_damping_differs_by_the_decrement() -> None:
    wrong = {row.quantity: row for row in ROWS if not row.agrees}
    assert set(wrong) == {
        *("zeta_upperleg", "zeta_lowerleg", "zeta_lowerleg_total"),
        *("c_hip", "c_knee", "c_tot", "filter_attenuation"),
    }
    for name, part in (
        ("c_hip", "upperleg"),
        ("c_knee", "lowerleg"),
        ("c_tot", "lowerleg_total"),
    ):
        delta = CHAPTER_3[f"delta_{part}"].value
        assert delta is not None
        ratio = wrong[name].derived / wrong[name].printed
        assert ratio == pytest.approx(1 / delta, rel=0.09)
        assert wrong[name].low > 2 * wrong[name].printed


def test_the_filters_two_readings_are_both_listed() -> None:
    found = sorted(r.derived for r in ROWS if r.quantity == "filter_attenuation")
    assert found == pytest.approx([58.08, 121.93], abs=0.01)


def test_a_changed_datum_turns_agreement_into_difference() -> None:
    doubled = CHAPTER_3.merged([PRINTED["I_gear"]]).with_values({"f_upperleg": 2.02})
    row = next(r for r in recomputed(doubled) if r.quantity == "omega_upperleg")
    assert not row.agrees
    assert row.relative_difference == pytest.approx(1.0, abs=0.02)


def test_every_number_names_its_place_in_the_thesis() -> None:
    for parameter in CHAPTER_3.members:
        if parameter.name == "g":
            continue
        assert isinstance(parameter.source, Published)
        assert "FlegX thesis, " in parameter.source.reference
        assert parameter.rounding is not None


def test_refuses_a_number_without_rounding() -> None:
    unknown = replace(CHAPTER_3["f_upperleg"], rounding=None)
    with pytest.raises(CharacterisationError, match="'f_upperleg' has no value or"):
        recomputed(CHAPTER_3.merged([PRINTED["I_gear"], unknown]))
