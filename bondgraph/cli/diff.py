"""``bondgraph diff``: what changed between two versions of a model."""

import click

from bondgraph.cli.command import Command, json_option
from bondgraph.cli.inputs import ModelName, read_model
from bondgraph.cli.session import Session
from bondgraph.reporting.differences import describe_difference

DIFFERENT = 1


@click.command(
    "diff",
    cls=Command,
    examples=(
        ("diff before.py:leg after.py:leg", "One sentence per change"),
        ("diff leg.py fitted.py", "What a fit has moved"),
    ),
)
@click.argument("before", type=ModelName())
@click.argument("after", type=ModelName())
@json_option
@click.pass_obj
def command(
    session: Session, /, *, before: str, after: str, json_file: str | None
) -> int:
    """Say what changed from the model BEFORE to the model AFTER.

    Compared by name; the order in which things were written is not a change. Exit
    status 1 if they differ.
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
