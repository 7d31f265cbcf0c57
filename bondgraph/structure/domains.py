"""Energy domains: what effort, flow, momentum and displacement are called.

In every domain power is effort times flow, momentum is the integral of effort and
displacement the integral of flow. The thermal domain is a pseudo bond graph: its
effort is temperature and its flow is heat flow, so e·f is not a power.
"""

from dataclasses import dataclass
from enum import StrEnum

from bondgraph.errors import StructureError, did_you_mean


class Quantity(StrEnum):
    """The four variables of a port."""

    EFFORT = "effort"
    FLOW = "flow"
    MOMENTUM = "momentum"
    DISPLACEMENT = "displacement"


@dataclass(frozen=True, slots=True)
class EnergyDomain:
    """The names and SI units of the four port variables in one domain.

    ``checked`` is False only for the analogue domain, whose units are whatever the
    recording says (volts that stand for metres, camera pixels).
    """

    name: str
    effort: str
    effort_unit: str
    flow: str
    flow_unit: str
    momentum: str
    momentum_unit: str
    displacement: str
    displacement_unit: str
    checked: bool = True

    def unit(self, quantity: Quantity) -> str:
        """Return the SI unit of `quantity` in this domain."""
        return str(getattr(self, f"{quantity.value}_unit"))

    def word(self, quantity: Quantity) -> str:
        """Return what `quantity` is called in this domain."""
        return str(getattr(self, quantity.value))


TRANSLATION = EnergyDomain(
    "translation", "force", "N", "velocity", "m/s",
    "momentum", "N*s", "position", "m",
)  # fmt: skip
ROTATION = EnergyDomain(
    "rotation", "torque", "N*m", "angular velocity", "rad/s",
    "angular momentum", "N*m*s", "angle", "rad",
)  # fmt: skip
ELECTRICAL = EnergyDomain(
    "electrical", "voltage", "V", "current", "A",
    "flux linkage", "V*s", "charge", "A*s",
)  # fmt: skip
HYDRAULIC = EnergyDomain(
    "hydraulic", "pressure", "Pa", "volume flow", "m^3/s",
    "pressure momentum", "Pa*s", "volume", "m^3",
)  # fmt: skip
THERMAL = EnergyDomain(
    "thermal", "temperature", "K", "heat flow", "W",
    "temperature integral", "K*s", "heat", "J",
)  # fmt: skip
ANALOGUE = EnergyDomain(
    "analogue", "effort", "1", "flow", "1/s",
    "momentum", "s", "displacement", "1", checked=False,
)  # fmt: skip

DOMAINS = {
    domain.name: domain
    for domain in (TRANSLATION, ROTATION, ELECTRICAL, HYDRAULIC, THERMAL, ANALOGUE)
}


def domain_named(name: str) -> EnergyDomain:
    """Return the energy domain called `name`.

    Raises
    ------
    StructureError
        If there is none of that name.
    """
    try:
        return DOMAINS[name]
    except KeyError:
        raise StructureError(
            f"There is no energy domain {name!r}.", (name,), did_you_mean(name, DOMAINS)
        ) from None
