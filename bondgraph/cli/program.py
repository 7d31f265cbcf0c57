"""The program: its commands, its exit status, and what is said when it fails.

Exit status 0: fine. 1: the answer is "no" (a check fails, a fit did not converge). 2:
the request cannot be served; one line on stderr says why and what to do. 130:
interrupted. A command is imported when it is called, so that ``bondgraph --help`` does
not wait for the libraries that only some commands need.
"""

import importlib
import os
import shlex
import sys
import traceback
from collections.abc import MutableMapping, Sequence
from typing import Any, NoReturn

import click

from bondgraph.cli.command import common_options, format_examples, format_options
from bondgraph.cli.session import Session
from bondgraph.errors import BondGraphError, did_you_mean

COMMANDS = {
    "derive": "Derive causality, state equations and transfer functions.",
    "check": "Compare derived gains, poles and zeros with declared values.",
    "draw": "Draw the graph with half arrows, strokes and names.",
    "simulate": "Drive the model with a recording and compare its outputs.",
    "fit": "Fit the parameters of a model to recordings.",
    "diagnose": "Say which physics a model leaves out, where, and show it.",
    "shape": "Size a controller for what is required of the loop.",
    "export": "Write the model as C, MATLAB, Modelica, LaTeX or Python text.",
    "diff": "Say what changed between two versions of a model.",
    "new": "Make a folder to start from: model, recordings, checks.",
    "demo": "Hide physics in a simulated machine and find it.",
    "completion": "Print what a shell needs to complete words.",
}
INTERRUPTED = 130
FIRST = (
    ("demo", "The main job on a simulated machine"),
    ("new mymachine --like motor", "A folder to start from"),
    ("diagnose axis.py run.csv --html report.html", "What a model leaves out"),
)


class Program(click.Group):
    """The commands, imported when they are called, and one way to fail."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of the commands in the order in which they are used."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import and return a command; each file ``cli/NAME.py`` holds ``command``."""
        if cmd_name not in COMMANDS:
            return None
        module = importlib.import_module(f"bondgraph.cli.{cmd_name}")
        command: click.Command = module.command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Refuse an unknown command by naming the closest ones."""
        if args[0] not in COMMANDS and not args[0].startswith("-"):
            raise click.UsageError(
                f"There is no command {args[0]!r}. {did_you_mean(args[0], COMMANDS)}"
            )
        return super().resolve_command(ctx, args)

    def format_options(
        self, ctx: click.Context, formatter: click.HelpFormatter
    ) -> None:
        """Write the commands, then the options."""
        self.format_commands(ctx, formatter)
        format_options(self, ctx, formatter)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write a first session as examples, and what an exit status means."""
        format_examples(FIRST, formatter)
        super().format_epilog(ctx, formatter)

    def format_commands(
        self, ctx: click.Context, formatter: click.HelpFormatter
    ) -> None:
        """List the commands without importing them."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def main(  # type: ignore[override]
        self, args: Sequence[str] | None = None, **extra: Any
    ) -> NoReturn:
        """Run the program and exit with its status."""
        session = Session()
        words = sys.argv[1:] if args is None else list(args)
        session.command = shlex.join(["bondgraph", *words])
        options: MutableMapping[str, Any] = {**extra, "obj": session}
        options["standalone_mode"] = False
        try:
            status = super().main(words, **options)
        except click.ClickException as error:
            status = session.refuse(_usage(error))
        except (click.Abort, KeyboardInterrupt):
            session.refuse(f"interrupted; {session.kept()}.")
            status = INTERRUPTED
        except (BondGraphError, OSError) as error:
            session.show_traceback(traceback.format_exc())
            status = session.refuse(_said(error))
        except Exception as error:
            session.show_traceback(traceback.format_exc())
            status = session.refuse(_bug(error, words, shown=session.traceback))
        sys.exit(status or 0)


def _usage(error: click.ClickException) -> str:
    """Return a wrong command line as one sentence and where to read more."""
    text = " ".join(error.format_message().split())
    context = error.ctx if isinstance(error, click.UsageError) else None
    if isinstance(error, click.NoSuchOption):
        text = _no_such_option(error)
    if context is None:
        return text
    return f"{text} See {context.command_path} --help."


def _no_such_option(error: click.NoSuchOption) -> str:
    known = set(error.possibilities or ())
    if error.ctx is not None:
        params = error.ctx.command.get_params(error.ctx)
        known |= {
            name for param in params for name in (*param.opts, *param.secondary_opts)
        }
    near = did_you_mean(error.option_name, (o for o in known if o[:1] == "-"))
    hint = f" {near}" if near.startswith("Did") else ""
    return f"There is no option {error.option_name}.{hint}"


def _said(error: BondGraphError | OSError) -> str:
    if isinstance(error, OSError):
        about = f"{error.filename!r}: " if error.filename is not None else ""
        return f"{about}{error.strerror or error}."
    return str(error)


def _bug(error: Exception, words: Sequence[str], *, shown: bool) -> str:
    text = f"this is a bug in bondgraph, please report it: {type(error).__name__}"
    said = f"{text}: {error}" if str(error) else text
    where = "" if shown else f" (bondgraph --traceback {' '.join(words)} shows where)"
    return f"{said}{where}"


@click.group(
    cls=Program,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="MODEL is file.py:factory or package.module:factory. Exit status: 0 fine, "
    "1 the answer is no, 2 the request cannot be served, 130 interrupted.",
    params=common_options(),
)
@click.version_option(package_name="bondgraph-workbench", prog_name="bondgraph")
@click.pass_context
def program(context: click.Context) -> None:
    """Bond graphs: from a drawn machine to the physics its model leaves out."""
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


def main() -> NoReturn:
    """Run ``bondgraph`` with the words of the command line."""
    # Its products are small: on several threads they take longer, not less.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    program.main(prog_name="bondgraph")
