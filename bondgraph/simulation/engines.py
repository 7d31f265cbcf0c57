"""How the equations of a simulation are evaluated, as objects; all agree to rounding.

A tape is ready at once and costs a jump per operation. Native code is ready after some
ten milliseconds and five to thirty times as fast.
"""

from dataclasses import dataclass

from bondgraph.numeric.model import NumericModel


@dataclass(frozen=True, slots=True)
class Interpreted:
    """Run the model's tape."""

    def compiles(self, model: NumericModel, samples: int) -> bool:
        """Return whether native code is to be used."""
        return False


@dataclass(frozen=True, slots=True)
class Native:
    """Compile the model, once per process and structure.

    Set-valued friction is not compiled; its model runs on the tape.
    """

    def compiles(self, model: NumericModel, samples: int) -> bool:
        """Return whether native code is to be used."""
        return model.set_valued is None


@dataclass(frozen=True, slots=True)
class WhenItPays:
    """Compile where a fit of that many samples wins back the time.

    Parameters
    ----------
    samples
        The shortest simulation that is worth it.
    operations
        The longest tape that is compiled; the time grows with its length.
    """

    samples: int = 250
    operations: int = 2000

    def compiles(self, model: NumericModel, samples: int) -> bool:
        """Return whether native code is to be used."""
        short = len(model.dynamics.code) + len(model.output.code) <= self.operations
        return model.set_valued is None and short and samples >= self.samples


Engine = Interpreted | Native | WhenItPays

PAYING = WhenItPays()
"""What simulations and fits use unless told otherwise."""
