"""What is checked of a loop: crossovers and margins around a derived plant."""

from collections.abc import Mapping
from math import isfinite

from bondgraph.checking.records import Check, CheckedQuantity
from bondgraph.equations.transfer.transfer_function import TransferFunction
from bondgraph.errors import CheckError
from bondgraph.loopshaping.loop import Loop, zero_pole_gain
from bondgraph.loopshaping.measures import LoopMeasures, measure


def loop_figures(
    check: Check, transfer_function: TransferFunction, values: Mapping[str, float]
) -> tuple[complex, ...]:
    """Return what the check's quantity is: one figure, or every crossover.

    Crossovers and bandwidth in rad/s, phase margin in degrees, delay margin in
    seconds.

    Raises
    ------
    CheckError
        If the closed loop is not stable, or has no such figure.
    """
    measured = measure(
        Loop(
            plant=zero_pole_gain(transfer_function, values),
            controller=check.controller,
            feedback=check.feedback,
        ),
        step=False,
    )
    if not measured.stable:
        raise CheckError(
            f"{measured.stability.value[:-1].lower()}, so it has no margins.",
            (),
            "Correct the controller or the model.",
        )
    found = tuple(f for f in _figures(check.quantity, measured) if isfinite(f))
    if not found:
        raise CheckError(
            f"the loop has no {check.quantity.value.replace('_', ' ')}.",
            (),
            "Check another quantity.",
        )
    return tuple(map(complex, found))


def _figures(quantity: CheckedQuantity, measured: LoopMeasures) -> tuple[float, ...]:
    match quantity:
        case CheckedQuantity.GAIN_CROSSOVER:
            return tuple(c.omega for c in measured.gain_crossovers)
        case CheckedQuantity.PHASE_CROSSOVER:
            return tuple(c.omega for c in measured.phase_crossovers)
        case CheckedQuantity.PHASE_MARGIN:
            return (measured.phase_margin,)
        case CheckedQuantity.GAIN_MARGIN:
            return (measured.gain_margin,)
        case CheckedQuantity.DELAY_MARGIN:
            return (measured.delay_margin,)
        case CheckedQuantity.MODULUS_MARGIN:
            return (measured.modulus_margin,)
        case _:
            return () if measured.bandwidth is None else (measured.bandwidth,)
