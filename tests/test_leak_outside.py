"""Heat leaks from a stock past its walls to the room, whose temperature is known."""

from itertools import pairwise

import numpy as np
import pytest

from bondgraph import (
    BondGraph,
    C,
    FitSettings,
    Hold,
    R,
    Recording,
    Se,
    Sf,
    bind_to,
    fit,
)
from bondgraph.physics.leakage import Leak
from bondgraph.physics.places.everywhere import all_places
from bondgraph.physics.places.pair import StockPair
from bondgraph.physics.places.scales import Scales

CORE, WALL, SHELL, SKIN, LEAK = 40.0, 0.5, 90.0, 0.8, 0.3


def furnace():
    """Return a core in a shell, whose skin gives its heat to the room."""
    g = BondGraph("furnace", domain="thermal")
    g.zero("core", Sf("heater"), C("core_heat"))
    g.one("wall", R("lining"))
    g.zero("shell", C("shell_heat"))
    g.one("surface", R("skin"))
    g.zero("room", Se("room_temperature"))
    for first, second in pairwise(("core", "wall", "shell", "surface", "room")):
        g.join(first, second)
    g.measure("temperature", effort="core")
    numbers = {"core_heat": CORE, "shell_heat": SHELL}
    for name, value in numbers.items():
        g.parameter(name, value, "J/K", std=0.0)
    for name, value in {"lining": WALL, "skin": SKIN}.items():
        g.parameter(name, value, "K/W", std=0.0)
    return g.finish()


def warmed():
    """Return a recording of the core, which leaks to the room at 280 to 300 K."""
    step, rng = 1.0, np.random.default_rng(1)
    time = step * np.arange(1200)
    heater = np.repeat(rng.uniform(0.0, 200.0, 12), 100)
    room = 290.0 + 10.0 * np.sin(2 * np.pi * time / 700.0)
    core = shell = 290.0
    read = np.zeros(time.size)
    for k in range(time.size):
        read[k] = core
        for _ in range(20):
            through = (core - shell) / WALL
            lost = LEAK * (core - room[k])
            core += step / 20 * (heater[k] - through - lost) / CORE
            shell += step / 20 * (through - (shell - room[k]) / SKIN) / SHELL
    channels = {
        "heater": (heater, "W"),
        "room_temperature": (room, "K"),
        "temperature": (read + 0.05 * rng.normal(size=time.size), "K"),
    }
    return bind_to(furnace(), Recording.from_arrays("run", time, channels))


def pairs():
    """Return the pairs of the furnace's 0-junctions between which something may go."""
    places = all_places(furnace(), Scales())
    return {(p.name, p.second): p for p in places if isinstance(p, StockPair)}


def test_a_stock_and_what_is_held_outside_are_a_pair_but_where_a_wall_is_between():
    # Core and shell, shell and room have a resistance between them already.
    assert set(pairs()) == {("core", "room")}


def test_the_leak_to_the_room_is_found_with_its_size():
    (leak,) = Leak().propose(pairs()["core", "room"])
    assert "from core to room" in leak.words
    found = fit(leak.apply(furnace()), [warmed()], settings=FitSettings(hold=Hold.ZERO))
    (name,) = leak.strengths
    assert found.estimate(name).value == pytest.approx(LEAK, rel=0.01)
