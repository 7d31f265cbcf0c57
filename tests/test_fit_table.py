"""The table of estimates: the interval where it fits."""

from dataclasses import replace

import pytest

from bondgraph.fitting.result import Estimate
from bondgraph.reporting.tables import estimates_table


@pytest.fixture
def mass():
    return Estimate(
        name="mass", value=2.0, std=0.1, unit="kg", start=1.0, interval=(1.8, 2.21)
    )


def test_the_interval_is_shown_beside_the_estimate(mass):
    blind = Estimate(name="b", value=3.0, std=None, unit="N*s/m", start=1.0)
    heading, _, first, second = estimates_table([mass, blind], width=80).splitlines()
    assert "95 % interval" in heading
    assert "1.8 to 2.21" in first
    assert "not identifiable" in second
    assert " to " not in second


def test_the_ends_of_a_narrow_interval_are_told_apart(mass):
    narrow = replace(mass, value=0.21, std=4.4e-6, interval=(0.2099976, 0.2100152))
    assert "0.2099976 to 0.2100152" in estimates_table([narrow], width=80)


def test_the_interval_gives_way_where_lines_would_break(mass):
    table = estimates_table([mass], width=44)
    assert "interval" not in table
    assert "2.00 ± 0.10" in table


def test_no_interval_no_column():
    blind = Estimate(name="b", value=3.0, std=None, unit="N*s/m", start=1.0)
    assert "interval" not in estimates_table([blind], width=80)
