"""How the equations of a simulation are evaluated, as objects; all agree to rounding.

A tape is ready at once and costs a jump per operation. Native code is ready after some
ten milliseconds and five to thirty times as fast.
"""

from dataclasses import dataclass, replace

from bondgraph.numeric.model import NumericModel

WORTH_OPTIMISING = 20_000
"""Samples; a fit to fewer ends before optimised code has won back its time."""


@dataclass(frozen=True, slots=True)
class Interpreted:
    """Run the model's tape."""

    def compiles(self, model: NumericModel, samples: int) -> bool:
        """Return whether native code is to be used."""
        return False

    def optimises(self, samples: int) -> bool:
        """Return whether that code is to be the faster one."""
        return False


@dataclass(frozen=True, slots=True)
class Native:
    """Compile the model, once per process and structure.

    Set-valued friction is not compiled; its model runs on the tape.
    """

    def compiles(self, model: NumericModel, samples: int) -> bool:
        """Return whether native code is to be used."""
        return model.set_valued is None

    def optimises(self, samples: int) -> bool:
        """Return whether that code is to be the faster one."""
        return samples > WORTH_OPTIMISING


@dataclass(frozen=True, slots=True)
class WhenItPays:
    """Compile where a fit of that many samples wins back the time.

    Parameters
    ----------
    samples
        The shortest simulation that is worth it.
    operations
        The longest tape that is compiled; the time grows with its length.
    whole
        Samples of what each simulation is a part of; what pays for it pays for them.
    """

    samples: int = 250
    operations: int = 2000
    whole: int = 0

    def compiles(self, model: NumericModel, samples: int) -> bool:
        """Return whether native code is to be used."""
        short = len(model.dynamics.code) + len(model.output.code) <= self.operations
        enough = max(samples, self.whole) >= self.samples
        return model.set_valued is None and short and enough

    def optimises(self, samples: int) -> bool:
        """Return whether that code is to be the faster one."""
        return max(samples, self.whole) > WORTH_OPTIMISING

    def for_parts_of(self, samples: int) -> "WhenItPays":
        """Return the engine of simulations of some windows of so many samples.

        A fit asks for all windows and for some in turn; for those it has the code.
        """
        return replace(self, whole=samples)


Engine = Interpreted | Native | WhenItPays

PAYING = WhenItPays()
"""What simulations and fits use unless told otherwise."""
