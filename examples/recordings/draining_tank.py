"""A tank that drains through a hole: capacity and a linear outlet.

    python examples/recordings/prepare.py draining_tank ../shared/recordings prepared
    bondgraph diagnose examples/recordings/draining_tank.py \
        prepared/empty_train.csv --held-out prepared/empty_test.csv

The recordings (Fabusola and Simon, Chemical Engineering Science 309, 2025) begin while
the tank is filled; the preparation keeps the time in which it drains. The outflow goes
with the root of the level (Torricelli), which the linear outlet leaves out. Only the
ratio of outlet and capacity shows in the level, so the capacity is held at 100 cm².
"""

from bondgraph import BondGraph, C, R, effort

WATER = 9.81 * 1000
"""Weight of water, N/m³."""


def tank() -> BondGraph:
    """Return the tank; its level is the pressure at the hole over the weight."""
    plant = BondGraph("draining tank", domain="hydraulic")
    plant.zero("tank", C("capacity"), R("outlet"))
    plant.measure("level", effort("tank") / WATER, unit="m")
    plant.parameter("capacity", 1e-2 / WATER, "m^3/Pa", std=0.0)
    plant.parameter("outlet", 2e8, "Pa*s/m^3", bounds=(0, 1e15))
    return plant
