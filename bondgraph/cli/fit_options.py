"""The options of commands that simulate and fit, as the settings they stand for.

How long at a stretch and what lies between two samples of an input; for fits also what
a residual costs, how the noise is coloured, and from how many starts.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from typing import Any, TypeVar

import click

from bondgraph.cli.command import OneOf, WholeNumber, positive_number
from bondgraph.fitting.estimate import FitSettings
from bondgraph.fitting.horizon import Automatic, Horizon, Seconds, WholeRecordings
from bondgraph.fitting.loss import Huber, Loss, SquaredError, StudentT
from bondgraph.fitting.noise import AutoregressiveNoise, Noise, WhiteNoise
from bondgraph.fitting.starts import ManyStarts, OneStart
from bondgraph.simulation.solvers import Hold, Sdirk2

F = TypeVar("F", bound=Callable[..., Any])
_LOSSES: dict[str, Loss] = {
    "squared": SquaredError(),
    "huber": Huber(),
    "student": StudentT(),
}
_NOISES: dict[str, Noise] = {"white": WhiteNoise(), "coloured": AutoregressiveNoise()}
_HOLDS = {"zero": Hold.ZERO, "first": Hold.FIRST}


def _horizon(ctx: click.Context, param: click.Parameter, value: str) -> Horizon:
    """Return what ``whole``, ``auto`` or a number of seconds means."""
    if value in ("whole", "auto"):
        return WholeRecordings() if value == "whole" else Automatic()
    seconds = positive_number(value)
    if seconds is None:
        raise click.BadParameter(
            f"{value!r} is not 'whole', 'auto' or a number of seconds.", ctx, param
        )
    return Seconds(seconds)


def fit_options(*, window: str) -> Callable[[F], F]:
    """Add ``--window`` and ``--hold``; the command gets them as ``settings``.

    And ``either_hold``, whether the recordings decide how inputs are held.

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
            settings = FitSettings(horizon=horizon, hold=_HOLDS.get(hold, Hold.FIRST))
            either = hold == "auto"
            return command(*args, settings=settings, either_hold=either, **options)

        with_hold = click.option(
            "--hold",
            type=OneOf(["auto", *_HOLDS]),
            default="auto",
            show_default=True,
            help="Inputs between samples: held, as commands in steps are (zero), "
            "straight lines (first), or as fits the recordings better (auto).",
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


def substeps_option(command: F) -> F:
    """Add ``--substeps`` to the ``settings``; it goes below `fit_options`."""

    @wraps(command)
    def with_substeps(
        *args: Any, settings: FitSettings, substeps: int, **options: Any
    ) -> Any:
        finer = replace(settings, solver=Sdirk2(substeps))
        return command(*args, settings=finer, **options)

    return click.option(  # type: ignore[return-value]
        "--substeps",
        type=WholeNumber(min=1),
        default=1,
        show_default=True,
        help="Steps of the solver between two samples.",
    )(with_substeps)


def estimation_options(command: F) -> F:
    """Add what a fit may be told of itself to the ``settings``.

    ``--loss``, ``--noise``, ``--starts``, ``--seed`` and ``--iterations``.

    It goes below `fit_options`, which makes them.
    """

    @wraps(command)
    def with_choices(
        *args: Any,
        settings: FitSettings,
        loss: str,
        noise: str,
        starts: int,
        seed: int,
        iterations: int,
        **options: Any,
    ) -> Any:
        chosen = replace(
            settings,
            iterations=iterations,
            loss=_LOSSES[loss],
            noise=_NOISES[noise],
            starts=OneStart() if starts == 1 else ManyStarts(count=starts, seed=seed),
        )
        return command(*args, settings=chosen, **options)

    for option in (
        click.option(
            "--iterations",
            type=WholeNumber(min=1),
            default=FitSettings().iterations,
            show_default=True,
            help="So many steps a fit may take before it is called not converged.",
        ),
        click.option(
            "--seed",
            type=int,
            default=0,
            show_default=True,
            help="Of the random starts.",
        ),
        click.option(
            "--starts",
            type=WholeNumber(min=1),
            default=1,
            show_default=True,
            help="Starts: the model's values, the others within a factor of three.",
        ),
        click.option(
            "--noise",
            type=OneOf(list(_NOISES)),
            default="white",
            show_default=True,
            help="Weigh residuals as white or as first-order coloured noise.",
        ),
        click.option(
            "--loss",
            type=OneOf(list(_LOSSES)),
            default="squared",
            show_default=True,
            help="What a residual costs; huber and student bear outliers.",
        ),
    ):
        with_choices = option(with_choices)
    return with_choices  # type: ignore[return-value]
