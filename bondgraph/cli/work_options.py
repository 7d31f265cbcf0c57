"""The options of a command with much to do: where it is done, and for how long."""

from collections.abc import Callable
from functools import wraps
from importlib import import_module
from typing import Any, TypeVar

import click

from bondgraph.cli.command import WholeNumber, positive_number
from bondgraph.diagnosis.work.workers import On, Processes, Where
from bondgraph.errors import MissingExtraError

F = TypeVar("F", bound=Callable[..., Any])


def time_limit(ctx: click.Context, param: click.Parameter, value: str) -> float | None:
    """Return the seconds of a number of minutes; None where the word is ``none``."""
    if value == "none":
        return None
    minutes = positive_number(value)
    if minutes is None:
        raise click.BadParameter(
            f"{value!r} is not 'none' or a number of minutes.", ctx, param
        )
    return 60.0 * minutes


def work_options(command: F) -> F:
    """Add ``--workers`` and ``--dask``; the command gets them as ``where``."""

    @wraps(command)
    def with_where(
        *args: Any, workers: int | None, dask: str | None, **rest: Any
    ) -> Any:
        if dask is None:
            return command(*args, where=Processes(workers), **rest)
        if workers is not None:
            raise click.UsageError("--workers has no use where --dask is given.")
        return command(*args, where=_cluster(dask), **rest)

    with_dask = click.option(
        "--dask",
        metavar="ADDRESS",
        help="Try hypotheses on the Dask cluster whose scheduler is there.",
    )(with_where)
    return click.option(  # type: ignore[return-value]
        "--workers",
        type=WholeNumber(min=1),
        metavar="N",
        help="Processes to try hypotheses in; one per core by default.",
    )(with_dask)


def _cluster(address: str) -> Where:
    """Return the executor of a Dask cluster.

    Raises
    ------
    MissingExtraError
        If Dask is not installed.
    """
    try:
        distributed = import_module("distributed")
    except ModuleNotFoundError as error:
        raise MissingExtraError(
            "--dask needs distributed.",
            ("distributed",),
            "Install bondgraph-workbench[dask].",
        ) from error
    client = distributed.Client(address)
    return On(client.get_executor(), workers=max(len(client.nthreads()), 1))
