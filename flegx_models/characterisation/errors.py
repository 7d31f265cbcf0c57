"""The one refusal of the characterisation: measurements that do not give the answer."""

from bondgraph import BondGraphError


class CharacterisationError(BondGraphError):
    """Measurements from which the asked quantity cannot be found."""
