"""Transfer functions of all outputs and inputs, as one record with names."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import sympy

from bondgraph.equations.algebra.factors import for_reading
from bondgraph.equations.transfer.transfer_function import TransferFunction
from bondgraph.errors import EquationError, did_you_mean


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferMatrix:
    """Transfer functions by output (row) and input (column).

    ``matrix["theta", "T_motor"]`` and ``matrix[0, 0]`` are the same entry.
    """

    name: str
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    entries: tuple[tuple[TransferFunction, ...], ...]

    def __getitem__(self, place: tuple[str | int, str | int]) -> TransferFunction:
        output, source = place
        row = self._index(output, self.outputs, "output")
        return self.entries[row][self._index(source, self.inputs, "input")]

    def _index(self, key: str | int, names: tuple[str, ...], kind: str) -> int:
        if key in names:
            return names.index(str(key))
        if isinstance(key, int) and -len(names) <= key < len(names):
            return key
        raise EquationError(
            f"{self.name!r} has no {kind} {key!r}.",
            (str(key),),
            did_you_mean(str(key), names),
        )

    def __iter__(self) -> Iterator[TransferFunction]:
        return (entry for row in self.entries for entry in row)

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of outputs and inputs."""
        return len(self.outputs), len(self.inputs)

    @property
    def expression(self) -> sympy.ImmutableDenseMatrix:
        """The matrix of expressions in s, factored for reading.

        Where a parameter is called s, all of them are written in p.
        """
        inside = [
            c
            for entry in self
            for c in (*entry.numerator_coefficients, *entry.denominator_coefficients)
        ]
        entries = [for_reading(entry.textbook, inside) for entry in self]
        return sympy.ImmutableDenseMatrix(*self.shape, entries)

    def at(
        self, frequency: complex, values: Mapping[str, float]
    ) -> tuple[tuple[complex, ...], ...]:
        """Return the complex gains at s = `frequency` (1/s), row by row."""
        return tuple(
            tuple(entry.at(frequency, values) for entry in row) for row in self.entries
        )

    def __str__(self) -> str:
        return "\n".join(map(str, self))

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {sympy.latex(self.expression)}$"
