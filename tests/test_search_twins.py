"""Laws that come equally far count as one among those that are fitted to the end."""

from types import SimpleNamespace

import pytest

from bondgraph.diagnosis.search.laws.fits import ShortFit, _kept


def come(*reductions):
    """Return short fits of laws of no common kind, each with something left of it."""
    fits = []
    for i, reduction in enumerate(reductions):
        law = SimpleNamespace(
            physics=f"law {i}",
            place="somewhere",
            strengths=(),
            contains=lambda _: False,
        )
        fits.append(ShortFit(reduction, law, {"values": {}}))
    return fits


@pytest.mark.parametrize(
    ("reductions", "most", "kept"),
    [
        ((0.9, 0.8, 0.7), 2, 2),
        ((0.9, 0.8, 0.8 - 1e-6, 0.8 - 2e-6, 0.75), 2, 4),
        ((0.9, 0.9 - 5e-5, 0.9 - 10e-5, 0.9 - 15e-5), 1, 4),
        ((0.9, 0.899), 1, 1),
        ((0.9, 0.5), 4, 1),
        ((), 4, 0),
    ],
    ids=["others", "twins", "a chain", "near", "behind", "none"],
)
def test_twins_keep_nobody_out(reductions, most, kept):
    there = come(*reductions)
    assert _kept(there, 0.6, most) == there[:kept]
