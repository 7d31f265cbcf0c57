"""``bondgraph shape``: a controller for a model, sized for what is required of it."""

from pathlib import Path

import click

from bondgraph.cli.command import Command, json_option
from bondgraph.cli.inputs import model_argument, read_model
from bondgraph.cli.output_file import OutputFile
from bondgraph.cli.session import Session
from bondgraph.cli.shaping_file import ShapingRequest, read_request
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.transfer.linear import linearise
from bondgraph.loopshaping.loop import zero_pole_gain
from bondgraph.loopshaping.shaping import shape
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain
from bondgraph.numeric.state_space import from_equations
from bondgraph.reporting.loop_pictures import loop_sheet, write_picture
from bondgraph.reporting.loop_tables import design_text, design_to_dict
from bondgraph.structure.graph import FinishedGraph

MOST_STATES = 12
"""Larger models are factored from their matrices, not from a closed form."""


@click.command(
    "shape",
    cls=Command,
    examples=(
        ("shape leg.py:flight --spec loop.toml", "The fastest loop that FILE allows"),
        ("shape leg.py:flight --spec loop.toml -o loop.svg", "With charts of the loop"),
    ),
)
@model_argument
@click.option(
    "--spec",
    required=True,
    metavar="FILE",
    type=click.Path(allow_dash=True),
    help="TOML with controller, filters and requirements; see docs/loop_shaping.md.",
)
@click.option(
    "-o",
    "--output",
    metavar="FILE",
    type=OutputFile(),
    help="Write the charts of the loop: a .png, .svg or .pdf.",
)
@json_option
@click.pass_obj
def command(
    session: Session,
    /,
    *,
    model: str,
    values: tuple[str, ...],
    spec: str,
    output: str | None,
    json_file: str | None,
) -> int:
    """Size a controller for MODEL: the fastest crossover that FILE allows.

    Exit status 1 if the requirements cannot be met; the nearest controller is shown
    then, with what is missing.
    """
    session.answers_in(json_file)
    request = read_request(Path(spec))
    plant = request.series * _plant(read_model(model, values), request)
    with session.progress() as progress:
        progress("sizing the controller")
        design = shape(
            plant,
            request.controller(plant),
            request.specification,
            feedback=request.feedback,
            free=request.free,
        )
    session.say(design_text(design))
    if output is not None:
        prototype = request.specification.prototype
        write_picture(loop_sheet(design.loop, prototype=prototype), output)
        session.wrote(output)
    session.deliver(json_file, design_to_dict(design))
    return 0 if design.met else 1


def _plant(graph: FinishedGraph, request: ShapingRequest) -> ZeroPoleGain:
    """Return the model from its input to its output, at its parameter values.

    Small models go through the symbolic transfer function, in which a pole at the
    origin is exactly there.
    """
    equations = derive(graph)
    numbers = graph.parameters.values_by_name()
    if len(equations.states) > MOST_STATES:
        return zero_pole_gain(
            from_equations(equations, numbers, at=request.at),
            output=request.output,
            input=request.input,
            delay=request.delay,
        )
    linear = linearise(equations, request.at)
    transfer = linear.transfer_function(request.output, request.input)
    return zero_pole_gain(transfer, numbers, delay=request.delay)
