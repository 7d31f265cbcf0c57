"""The gallery: machines of the catalogue and of the examples, drawn as they are."""

import sys
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path
from types import ModuleType

from bondgraph import FinishedGraph, assign_causality, draw_svg, to_python
from bondgraph.loading import load_model

ROOT = Path(__file__).resolve().parents[2]

SHOWN: Mapping[str, Mapping[str, str]] = {
    "Mechanics": {
        "spring_mass_damper": "A mass on a spring and a damper",
        "quarter_car": "A quarter of a car",
        "vibration_absorber": "A vibration absorber",
        "rack_and_pinion": "Rack and pinion",
        "differential_gear": "A differential gear",
        "slipping_clutch": "A clutch that slips",
    },
    "Linkages: transformers that move": {
        "cart_and_pole": "Cart and pole",
        "crank_and_slider": "Crank and slider",
        "spring_pendulum": "A pendulum on a spring",
    },
    "Electrical and electromechanical": {
        "rlc_series": "R, L and C in series",
        "wheatstone_bridge": "A Wheatstone bridge",
        "chua": "Chua's circuit",
        "dc_motor": "A motor",
        "geared_motor_with_flexible_shaft": "A geared motor with a flexible shaft",
        "loudspeaker": "A loudspeaker",
        "step_up_converter": "A step-up converter",
    },
    "Hydraulics": {
        "coupled_tanks_with_orifices": "Two tanks with orifices",
        "differential_cylinder": "A differential cylinder",
        "hydrostatic_transmission": "A hydrostatic transmission",
        "surge_tank": "A surge tank",
    },
    "Heat and chemistry": {
        "two_rooms": "Two rooms",
        "self_heating_coil": "A coil that heats itself",
        "reaction": "A reaction",
    },
}
"""Cases of the catalogue by subject, with what a reader calls them."""

RECORDED: Mapping[str, str] = {
    "examples/recordings/emps.py:carriage": "EMPS, a positioning axis",
    "examples/recordings/tanks.py:tanks": "The cascaded tanks",
    "examples/recordings/silverbox.py:oscillator": "Silverbox",
    "examples/recordings/worm_drive.py:drive": "A worm drive",
    "examples/recordings/two_link_flexible.py:arm": "An arm with two flexible joints",
    "flegx_models.models:lowerleg_flight": "FlegX: the lower leg in flight",
    "flegx_models.models:lowerleg_stance": "FlegX: the lower leg in stance",
    "flegx_models.planar_leg:flying_leg": "FlegX: the whole leg in the air",
}
"""Models of real machines, by how the command line calls them."""


def pages() -> dict[str, str]:
    """Return the page and its pictures by file name."""
    files: dict[str, str] = {}
    parts = list(_catalogue(files))
    parts.append("## Machines that were recorded\n")
    for model, title in RECORDED.items():
        graph = load_model(str(ROOT / model) if "/" in model else model)
        parts.append(_machine(files, title, graph, f"`{model}`"))
    files["machines.inc"] = "\n".join(parts)
    return files


def _catalogue(files: dict[str, str]) -> Iterator[str]:
    cases = {case.name: case for case in _tests().CASES}
    for subject, names in SHOWN.items():
        yield f"## {subject}\n"
        for name, title in names.items():
            case = cases[name]
            home = f"{_home(case.make)}, with the answers it is held against"
            yield _machine(files, title, case.graph(), home, after=case.source)


def _machine(
    files: dict[str, str], title: str, graph: FinishedGraph, home: str, after: str = ""
) -> str:
    picture = f"{graph.name.replace(' ', '_').replace(',', '')}.svg"
    causality = assign_causality(graph)
    files[picture] = draw_svg(graph, assignment=causality, theme="light")
    states, depend = len(causality.integral), len(causality.derivative)
    counted = f"{states} state{'' if states == 1 else 's'}"
    counted += f", {depend} dependent" if depend else ""
    said = f"{counted}. In {home}." + (f" After {after}." if after else "")
    return (
        f"### {title}\n\n"
        f"![Bond graph: {title}](gallery/generated/{picture}){{.machine}}\n\n{said}\n\n"
        f"```{{raw}} html\n<details><summary>The model as text</summary>\n```\n"
        f"```python\n{to_python(graph).strip()}\n```\n"
        f"```{{raw}} html\n</details>\n```\n"
    )


def _home(make: Callable[[], object]) -> str:
    """Return the file of the function that writes a graph of the catalogue."""
    write = next(
        cell.cell_contents
        for cell in make.__closure__ or ()
        if callable(cell.cell_contents)
    )
    return f"`{Path(write.__code__.co_filename).resolve().relative_to(ROOT)}`"


@cache
def _tests() -> ModuleType:
    """Return the catalogue, which the tests keep."""
    sys.path.insert(0, str(ROOT / "tests"))
    try:
        import catalogue  # noqa: PLC0415
    finally:
        sys.path.remove(str(ROOT / "tests"))
    return catalogue
