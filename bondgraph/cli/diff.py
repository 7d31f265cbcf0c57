"""``bondgraph diff``: what changed between two versions of a model."""

import click

from bondgraph.cli.inputs import read_model
from bondgraph.cli.session import Session, json_option
from bondgraph.reporting.differences import describe_difference

DIFFERENT = 1


@click.command(
    "diff",
    epilog="Example: bondgraph diff before.py:leg after.py:leg says one R added at "
    "worm. Exit status: 0 no difference, 1 they differ.",
)
@click.argument("before")
@click.argument("after")
@json_option
@click.pass_obj
def command(
    session: Session, /, *, before: str, after: str, json_file: str | None
) -> int:
    """Say what changed from the model BEFORE to the model AFTER.

    Compared by name; the order in which things were written is not a change.
    """
    session.answers_in(json_file)
    one, other = read_model(before), read_model(after)
    changes = describe_difference(one, other)
    session.say("\n".join(changes) if changes else "no difference")
    session.deliver(
        json_file,
        {
            "schema": 1,
            "before": one.name,
            "after": other.name,
            "differences": list(changes),
        },
    )
    return DIFFERENT if changes else 0
