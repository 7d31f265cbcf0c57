"""Which Kalman filter carries the state of a fit by innovations, as objects."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Extended:
    """Slopes at the estimate, found anew until it stands still (iterated EKF).

    Right where laws are straight over the spread of the estimate; the fastest.
    """


@dataclass(frozen=True, slots=True)
class Unscented:
    """Means and covariances of points spread like the estimate (UKF).

    For laws that bend within the spread of the estimate, to second order in it (Julier
    and Uhlmann, Proc. IEEE 92, 2004). Slower than the extended filter: some ten times
    at two states, and by the number of states.

    Parameters
    ----------
    centre
        Julier's κ: the weight of the point in the middle is κ / (n + κ), and the others
        lie √(n + κ) standard deviations away.
    """

    centre: float = 1.0


KalmanFilter = Extended | Unscented
