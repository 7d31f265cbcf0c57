"""Whether what was found carries over to what was kept back."""

from dataclasses import dataclass

from bondgraph.diagnosis.records import Comparison, Verdict
from bondgraph.diagnosis.search.base.horizons import SAME

HALVED, UNMOVED = 0.5, 0.95
"""What halves the errors it was fitted to and leaves so much of held-out ones fits."""

SPOILT = 1.2
"""Where held-out errors grow by more than this factor, what was found is not the cause,
whatever the training recordings say.
"""


@dataclass(frozen=True, slots=True)
class Shown:
    """Errors before and after, of what was kept back and of what it was fitted to.

    Parameters
    ----------
    held_out, trained
        Whole recordings.
    stretches
        Of the held-out ones, where models were fitted over stretches.
    left_open
        Whether what is open of the model's numbers misses held-out recordings by as
        much.
    """

    held_out: Comparison
    trained: Comparison
    stretches: Comparison | None = None
    left_open: bool = False

    @property
    def idle(self) -> tuple[str, ...]:
        """What an addition leaves as it was of what was kept back, and could mend.

        None where it does not explain what it was fitted to, or mends some of it.
        """
        trained, held_out = self.trained, self.held_out
        if not trained.after.nrmse < HALVED * trained.before.nrmse:
            return ()
        before, after = held_out.before.rmse, held_out.after.rmse
        left = [n for n in before if HALVED * before[n] > trained.after.rmse[n]]
        idle = all(after[name] > UNMOVED * before[name] for name in left)
        return tuple(left) if idle else ()

    @property
    def helps_in_stretches(self) -> bool:
        """Whether it halves the errors of held-out stretches."""
        seen = self.stretches
        return seen is not None and seen.after.nrmse < HALVED * seen.before.nrmse

    @property
    def carries_over(self) -> bool:
        """Whether what was kept back does not speak against what was found."""
        if self.helps_in_stretches:
            return True
        spoilt = self.held_out.after.nrmse > SPOILT * self.held_out.before.nrmse
        return not spoilt and (self.left_open or not self.idle)


def worse_held_out(
    verdict: Verdict, statement: str, shown: Shown
) -> tuple[Verdict, str]:
    """Return the verdict where the improved model predicts what was kept back worse.

    Or no better, where it halves the error of what it was fitted to, and what was kept
    back has more than that to explain. A drive that is free to turn and once stands
    still where it moved is off for the rest of a recording: there shorter stretches
    say whether what was found carries over.
    """
    before, after = shown.held_out.before.nrmse, shown.held_out.after.nrmse
    told_something = verdict in (Verdict.PHYSICS_MISSING, Verdict.UNEXPLAINED)
    worse = after > SAME * before
    if not told_something or not (worse or shown.idle):
        return verdict, statement
    became = f"({100 * before:.3g} % became {100 * after:.3g} %)"
    if shown.stretches is not None and shown.helps_in_stretches:
        over = (
            f"({100 * shown.stretches.before.nrmse:.3g} % became "
            f"{100 * shown.stretches.after.nrmse:.3g} %)"
        )
        return verdict, (
            f"{statement} It carries over to the held-out recordings over stretches "
            f"as long as those it was fitted to {over}; run through as a whole they "
            f"are missed no less than before {became}."
        )
    if shown.left_open and shown.carries_over:
        return verdict, (
            f"{statement} The held-out recordings are predicted no better {became}, "
            "and tell nothing of it: what the others leave open of the model's numbers "
            "moves the prediction by as much. Recordings that go as far would tell."
        )
    told = (
        f"{statement} But on the held-out recordings the improved model is "
        f"{'worse' if worse else 'no better'} than the base model {became}: what was "
        "found holds where it was found and does not carry over."
    )
    return (verdict if shown.carries_over else Verdict.UNEXPLAINED), told
