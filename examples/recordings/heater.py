"""Two heaters on a board in still air, each with a thermistor: first order each.

    bondgraph diagnose examples/recordings/heater.py:heaters --window whole \
        --map heater1=heater1[W] --map heater2=heater2[W] \
        ../shared/recordings/heater/mimo_energy_balance.csv \
        --held-out ../shared/recordings/heater/mimo_second_order.csv

Heat is in units of a hundredth of full power, called watt here: only ratios of power,
capacity and conductance show in temperatures. The air of the room is a capacity too
large to change, so that its temperature is an initial state, estimated anew in every
recording. What it leaves out: the lag between heater and sensor, and the heat that
passes between the heaters (J. Hedengren, temperature control lab).
"""

from bondgraph import BondGraph, C, R, Sf, effort

ROOM = 1e6
"""Capacity of the room over that of a heater of 1: its temperature stays."""


def heaters() -> BondGraph:
    """Return both heaters, each losing heat to the room."""
    board = BondGraph("temperature control lab", domain="thermal")
    board.zero("room", C("air"))
    for number in ("1", "2"):
        board.zero(f"block{number}", Sf(f"heater{number}"), C(f"capacity{number}"))
        board.one(f"surface{number}", R(f"loss{number}"))
        board.join(f"block{number}", f"surface{number}")
        board.join(f"surface{number}", "room")
        board.measure(f"temperature{number}", effort(f"block{number}"))
        board.parameter(f"capacity{number}", 200.0, "J/K", bounds=(1, 1e5))
        board.parameter(f"loss{number}", 0.6, "K/W", bounds=(0, 100))
    board.parameter("air", ROOM * 200.0, "J/K", std=0.0)
    return board
