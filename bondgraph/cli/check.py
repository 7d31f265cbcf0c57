"""``bondgraph check``: declared against derived values, for CI."""

from pathlib import Path

import click

from bondgraph.checking.junit import write_junit
from bondgraph.checking.run import CheckReport, run_checks, shown
from bondgraph.cli.command import Command, json_option
from bondgraph.cli.output_file import OutputFile
from bondgraph.cli.session import Session
from bondgraph.cli.terminal import table_style
from bondgraph.reporting.tables import CheckRow, checks_table


@click.command(
    "check",
    cls=Command,
    examples=(
        ("check checks.toml", "Every declared value against the derived one"),
        ("check checks.toml --junit results.xml", "The same for a CI server"),
    ),
)
@click.argument("file", default="pyproject.toml", type=click.Path())
@click.option(
    "--junit", metavar="FILE", type=OutputFile(), help="Write the results as JUnit XML."
)
@json_option
@click.pass_obj
def command(
    session: Session, /, *, file: str, junit: str | None, json_file: str | None
) -> int:
    """Derive gains, poles and zeros afresh and compare them with FILE.

    FILE is TOML with [[check]] tables, or a pyproject.toml (the default) with
    [[tool.bondgraph.checks.check]]. Exit status 1 if one is off.
    """
    session.answers_in(json_file)
    report = run_checks(file)
    session.say(checks_table(_rows(report), **table_style(session)))
    if junit is not None:
        write_junit(report, Path(junit))
        session.wrote(junit)
    session.deliver(json_file, report.to_dict())
    count = len(report.results)
    if report.ok:
        session.say(f"\n{count} of {count} as declared.")
        return 0
    session.say()
    for result in report.failed:
        session.say(result.statement)
    session.say(f"{len(report.failed)} of {count} not as declared.")
    return 1


def _rows(report: CheckReport) -> list[CheckRow]:
    return [
        CheckRow(
            name=result.check.name,
            declared=shown(result.check.value),
            derived=shown(result.derived),
            tolerance=str(result.check.tolerance),
            ok=result.ok,
        )
        for result in report.results
    ]
