"""Transfer functions in symbols from a pencil, and the refusals that go with them."""

from collections.abc import Callable, Sequence

from bondgraph.equations.transfer.pencil import MOST_TERMS, Pencil
from bondgraph.equations.transfer.transfer_function import TransferFunction
from bondgraph.equations.transfer.transfer_matrix import TransferMatrix
from bondgraph.errors import EquationError, did_you_mean


def chosen(name: str | None, names: tuple[str, ...], kind: str, model: str) -> int:
    """Return the index of `name`, or of the only one, or refuse."""
    if name is None and len(names) == 1:
        return 0
    if name in names:
        return names.index(name)
    problem = (
        f"{model!r} has {len(names)} {kind}s; say which one."
        if name is None
        else f"{model!r} has no {kind} {name!r}."
    )
    raise EquationError(problem, (name or model,), did_you_mean(name or "", names))


def closed_form(
    pencil: Pencil,
    place: tuple[int, int],
    within: Sequence[int],
    names: tuple[str, str],
) -> TransferFunction:
    """Return the transfer function at `place` (output, input) called `names`.

    Raises
    ------
    EquationError
        If it has too many terms to be read, or the variables are not determined.
    """
    output, source = names
    found = pencil.transfer(*place, within)
    if found is None:
        raise EquationError(
            f"The transfer function from {source!r} to {output!r} goes through "
            f"{len(within)} states; its closed form has more than {MOST_TERMS} terms, "
            f"which nobody reads.",
            (source, output),
            "Put numbers in: make a StateSpace of the model, or put numbers for "
            "parameters in the matrices.",
        )
    if not found[1]:
        raise EquationError(
            f"The equations do not determine {output!r}.",
            (output,),
            "Put an R or a storage between the elements concerned.",
        )
    return TransferFunction(
        input=source,
        output=output,
        numerator_coefficients=found[0],
        denominator_coefficients=found[1],
    )


def all_closed_forms(
    name: str,
    outputs: tuple[str, ...],
    inputs: tuple[str, ...],
    form: Callable[[int, int], TransferFunction],
) -> TransferMatrix:
    """Return the matrix of transfer functions that `form` gives by place."""
    return TransferMatrix(
        name=name,
        outputs=outputs,
        inputs=inputs,
        entries=tuple(
            tuple(form(i, j) for j in range(len(inputs))) for i in range(len(outputs))
        ),
    )
