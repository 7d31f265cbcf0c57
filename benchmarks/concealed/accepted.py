"""Which answers count as right, written down before any result was looked at.

An answer is right about the physics if it says one of ``words``, and right about the
place if it names one of ``places``. Where two pieces of physics give the same readings
for every input, both are right, and the reason stands here.
"""

from dataclasses import dataclass

from benchmarks.concealed.effects import kind_of_place, law_of
from benchmarks.concealed.machine import Machine, Site

UNKNOWN = "unknown_relation"


@dataclass(frozen=True, slots=True)
class Accepted:
    """One right answer: any of the words at any of the places."""

    words: tuple[str, ...]
    places: tuple[str, ...]
    reason: str


WORDS: dict[str, tuple[tuple[str, ...], str]] = {
    "coulomb_friction": (("coulomb_friction",), "as concealed"),
    "voltage_drop": (
        ("voltage_drop", "coulomb_friction"),
        "a constant drop against the current is Coulomb's law in electrical words",
    ),
    "stribeck_friction": (("stribeck_friction",), "as concealed"),
    "lugre": (
        ("stribeck_friction", "hysteresis"),
        "LuGre is Stribeck friction with a memory; either half is a true statement",
    ),
    "maxwell_slip": (("hysteresis",), "play operators are hysteresis"),
    "direction_dependent_friction": (
        ("direction_dependent_friction",),
        "as concealed",
    ),
    "sensor_clipping": (
        ("sensor_nonlinearity", "saturation"),
        "clipping is a saturation of the sensor",
    ),
    "tabulated_law": ((UNKNOWN,), "no law of the library has this shape"),
    "periodic_and_quadratic": ((UNKNOWN,), "a mix of two laws in one element"),
    "speed_dependent_gain": ((UNKNOWN,), "a product of input and speed"),
    "sensor_drift": ((UNKNOWN, "sensor_bias"), "a bias that grows with time"),
    "input_scale": (("input_scale", "actuator_scale", UNKNOWN), "no agreed word"),
    "square_root_orifice": (
        ("square_root_orifice", "quadratic_drag"),
        "flow with the root of pressure is pressure with the square of flow",
    ),
    "leak": (
        ("leak", "viscous_friction"),
        "a flow proportional to effort, lost at a place; wording differs by domain",
    ),
    "diode": (
        ("overflow", "end_stop", "saturation", UNKNOWN),
        "a flow that begins above a threshold of effort; no word names it",
    ),
    "link_modes": (
        ("compliance", "added_compliance"),
        "many modes; the library has one spring, which is the nearest truth",
    ),
    "compliance": (("compliance", "added_compliance"), "one thing in two words"),
    "radiation": (("radiation", UNKNOWN), "not a word of the first vocabulary"),
}
"""Words by law; a law that is not listed has its own word only."""

OUTSIDE = frozenset(
    {"tabulated_law", "periodic_and_quadratic", "speed_dependent_gain", "sensor_drift"}
)
"""Laws that no library entry describes: `unexplained` at the place is right too."""


def accepted(machine: Machine, site: Site) -> tuple[Accepted, ...]:
    """Return every answer that is right for an effect at a site."""
    law = law_of(site)
    words, reason = WORDS.get(law, ((site.word,), "as concealed"))
    answers = [Accepted(words, _names(machine, site.place), reason)]
    where = kind_of_place(machine, site.place)
    answers += _signal_paths(machine, site, where)
    if where == "input" and law == "constant_bias":
        answers.append(
            Accepted(
                ("constant_bias",),
                machine.aliases.get(site.place, ()),
                "an input's bias is a constant effort where the input acts",
            )
        )
    if where == "place" and law == "constant_bias":
        inputs = tuple(
            name
            for name, _ in machine.inputs
            if site.place in machine.aliases.get(name, ())
        )
        reason = "a constant effort where the input acts is a bias of the input"
        answers.append(Accepted(("constant_bias",), inputs, reason))
    if machine.name == "pendulum" and law == "sensor_bias":
        answers.append(
            Accepted(
                ("gravity",),
                ("pivot",),
                "mgl sin(y - b) is gravity with another phase: the same readings",
            )
        )
    return tuple(answers)


def _signal_paths(machine: Machine, site: Site, where: str) -> list[Accepted]:
    """Return what equals a delay or lag in the one signal path of a machine.

    With one input and one output a delay may sit at either end: the equations do not
    contain time. A lag may be exchanged too where they are linear.
    """
    single = len(machine.inputs) == 1 and len(machine.sensors) == 1
    exchangeable = site.word == "delay" or (site.word == "lag" and machine.linear)
    if where == "place" or not single or not exchangeable:
        return []
    ends = (machine.inputs[0][0], machine.sensors[0].name)
    places = tuple(name for end in ends for name in _names(machine, end))
    return [Accepted((site.word,), places, "one signal path: both ends are the same")]


def _names(machine: Machine, place: str) -> tuple[str, ...]:
    """Return all names of the user's model for one place."""
    return (place, *machine.aliases.get(place, ()))


def table(machines: list[Machine]) -> str:
    """Return the table of accepted answers as Markdown."""
    rows = ["| machine | concealed | accepted | reason |", "|---|---|---|---|"]
    for machine in machines:
        for site in machine.sites:
            for one in accepted(machine, site):
                what = " or ".join(one.words) + " at " + ", ".join(one.places)
                if site.silent:
                    what = "nothing: the base model's own parameter takes it"
                rows.append(
                    f"| {machine.name} | {law_of(site)} at {site.place} | {what} | "
                    f"{one.reason} |"
                )
    return "\n".join(rows)
