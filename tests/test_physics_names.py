"""A law is called what those call it who work in the domain that it is in."""

from dataclasses import replace

import pytest
from judged_candidates import judged

from bondgraph.diagnosis.answer.wording import finding_statement
from bondgraph.diagnosis.records import Evidence, Finding, Support
from bondgraph.fitting.result import Estimate
from bondgraph.physics.library import LIBRARY
from bondgraph.physics.names import ELSEWHERE, NAMES, SOFTER, name_of


@pytest.mark.parametrize(
    ("domain", "name"),
    [
        ("translation", "a hardening spring"),
        ("hydraulic", "a stock that stiffens"),
        ("thermal", "a heat capacity that falls as it warms"),
        ("", "a hardening spring"),
    ],
)
def test_no_spring_is_told_of_a_tank_or_an_oven(domain, name):
    assert name_of("hardening_spring", domain) == name
    evidence = Evidence(
        physics="hardening_spring", place="tank", law="q**3", domain=domain,
        support=Support.SUPPORTED, gain=0.9, gain_std=0.1, train_nrmse=0.1, reason="",
    )  # fmt: skip
    assert evidence.name == name


def test_a_stock_that_softens_is_told_by_the_sign_of_its_number():
    chosen = judged(0.1, physics="hardening_spring", place="tank", domain="hydraulic")
    chosen.candidate.hypothesis.words = "tank gives a pressure that bends"
    estimate = Estimate(
        name="cubic_tank", value=-4.0, std=0.2, unit="Pa/(m^3)^3", start=None
    )
    told = finding_statement(chosen, (), (), (estimate,))
    assert told.startswith("A stock that softens at tank was left out")
    finding = Finding(
        physics="hardening_spring", place="tank", element="store", domain="hydraulic",
        statement=told, law="q**3", estimates=(estimate,),
    )  # fmt: skip
    assert finding.name == "a stock that softens"
    assert replace(finding, estimates=()).name == "a stock that stiffens"


def test_only_words_of_the_library_are_named():
    words = {physics.word for physics in LIBRARY}
    told = {physics for names in ELSEWHERE.values() for physics in names}
    assert told | set(NAMES) <= words
    usual = set(NAMES.values()) | {n for d in ELSEWHERE.values() for n in d.values()}
    assert set(SOFTER) <= usual
