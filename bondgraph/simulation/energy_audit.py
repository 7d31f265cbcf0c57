"""The energy audit of a simulation: what came in is stored or dissipated."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class EnergyAudit:
    """Energies in J between the first and the last sample.

    Parameters
    ----------
    stored
        What the storages have gained.
    dissipated, supplied
        What resistances took, and what sources gave.
    exchanged
        What came in by another way: with a law that time or another place moves, or
        from a pseudo domain.
    relative
        Stored plus dissipated minus what came in, over the energy that flowed: nan
        where an exchange has no formula, so that the balance says nothing.
    """

    stored: float
    dissipated: float
    supplied: float
    relative: float
    exchanged: float = 0.0

    @property
    def has_flowed(self) -> bool:
        """Whether there is anything to account for."""
        return any((self.stored, self.dissipated, self.supplied, self.exchanged))


def audit_of(accounts: Array, stored: Array, *, closed: bool) -> EnergyAudit:
    """Return the audit of a run.

    Parameters
    ----------
    accounts
        Energies supplied, dissipated, exchanged and flowed since the start,
        ``[sample, account]``.
    stored
        The energy in every storage, ``[sample, storage]``.
    closed
        Whether everything that exchanges power was counted.
    """
    supplied, dissipated, exchanged, flowed = accounts[-1] - accounts[0]
    gained = float((stored[-1] - stored[0]).sum())
    # What swings between storages flows as well.
    moved = np.abs(stored - stored[0]).max(axis=0, initial=0.0).sum()
    scale = max(float(flowed), float(moved))
    left = abs(gained + dissipated - supplied - exchanged)
    relative = left / scale if scale > 0.0 else 0.0
    return EnergyAudit(
        stored=gained,
        dissipated=float(dissipated),
        supplied=float(supplied),
        exchanged=float(exchanged),
        relative=float(relative) if closed else float("nan"),
    )


def together(audits: Sequence[EnergyAudit]) -> EnergyAudit:
    """Return the audit of several runs: sums, and the worst of the relative balances.

    That is nan where one of them is.
    """
    return EnergyAudit(
        stored=sum(one.stored for one in audits),
        dissipated=sum(one.dissipated for one in audits),
        supplied=sum(one.supplied for one in audits),
        exchanged=sum(one.exchanged for one in audits),
        relative=float(np.max([one.relative for one in audits], initial=0.0)),
    )
