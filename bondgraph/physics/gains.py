"""A channel in another proportion, about the zero of what it is told in.

The error of a gain grows from where the instrument reads zero. An absolute temperature
is told in kelvin here, but thermometers and heaters' controllers are calibrated in
degrees Celsius.
"""

import sympy

from bondgraph.physics.places.base import Coefficient
from bondgraph.physics.places.channels import ChannelPlace
from bondgraph.structure.domains import THERMAL

FAR_FROM_ZERO = 0.3
"""A range whose near end is so far out, of its far one, does not begin at zero: an
absolute temperature, a pressure above a pressure.
"""

FREEZING = 273.15
"""Kelvin at which a thermometer in degrees Celsius reads zero."""


def in_proportion(
    place: ChannelPlace, scale: Coefficient
) -> tuple[sympy.Expr, tuple[Coefficient, ...]]:
    """Return the signal of a channel times a factor, and what that takes."""
    if not _is_absolute_temperature(place):
        return scale.symbol * place.signal, (scale,)
    zero = place.constant("zero_celsius", place.channel_unit, FREEZING)
    law = zero.symbol + scale.symbol * (place.signal - zero.symbol)
    return law, (scale, zero)


def is_far_from_zero(low: float, high: float) -> bool:
    """Return whether a range does not begin at zero."""
    near, far = sorted((abs(low), abs(high)))
    return low * high > 0.0 and near > FAR_FROM_ZERO * far


def _is_absolute_temperature(place: ChannelPlace) -> bool:
    kelvin = place.domain == THERMAL and place.channel_unit == "K"
    return kelvin and is_far_from_zero(*place.range)
