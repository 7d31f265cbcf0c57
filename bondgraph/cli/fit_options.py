"""The options of commands that simulate: how long at a stretch, and what lies between
two samples of an input.
"""  # noqa: D205  (one sentence)

import math
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

import click

from bondgraph.fitting.estimate import Settings
from bondgraph.fitting.horizon import Automatic, Horizon, Seconds, WholeRecordings
from bondgraph.simulation.solvers import Hold

F = TypeVar("F", bound=Callable[..., Any])
_HOLDS = {"zero": Hold.ZERO, "first": Hold.FIRST}


def _horizon(ctx: click.Context, param: click.Parameter, value: str) -> Horizon:
    """Return what ``whole``, ``auto`` or a number of seconds means."""
    if value in ("whole", "auto"):
        return WholeRecordings() if value == "whole" else Automatic()
    try:
        seconds = float(value)
    except ValueError:
        seconds = math.nan
    if not 0 < seconds < math.inf:
        raise click.BadParameter(
            f"{value!r} is not 'whole', 'auto' or a number of seconds.", ctx, param
        )
    return Seconds(seconds)


def fit_options(*, window: str) -> Callable[[F], F]:
    """Add ``--window`` and ``--hold``; the command gets them as ``settings``.

    Parameters
    ----------
    window
        The default of ``--window``.
    """

    def add(command: F) -> F:
        @wraps(command)
        def with_settings(
            *args: Any, horizon: Horizon, hold: str, **options: Any
        ) -> Any:
            settings = Settings(horizon=horizon, hold=_HOLDS[hold])
            return command(*args, settings=settings, **options)

        with_hold = click.option(
            "--hold",
            type=click.Choice(list(_HOLDS)),
            default="first",
            show_default=True,
            help="Inputs between samples: held (zero) or straight lines (first).",
        )(with_settings)
        return click.option(  # type: ignore[return-value]
            "--window",
            "horizon",
            callback=_horizon,
            default=window,
            show_default=True,
            metavar="SECONDS|whole|auto",
            help="How long to simulate from each estimated initial state.",
        )(with_hold)

    return add
