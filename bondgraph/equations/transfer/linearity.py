"""Whether a linear form holds everywhere, or about an operating point only."""

from bondgraph.equations.state_equations import StateEquations


def is_linear(equations: StateEquations) -> bool:
    """Return whether no slope of the equations depends on states, inputs or time.

    A model whose equations are linear assignment by assignment is linear; one of which
    two nonlinear assignments cancel is not recognised as such.
    """
    parameters = set(equations.parameters)
    expressions = [
        *(assignment.expression for assignment in equations.assignments),
        *equations.rates,
        *equations.residuals,
        *(output.expression for output in equations.outputs),
    ]
    return all(
        expression.diff(symbol).free_symbols <= parameters
        for expression in expressions
        for symbol in expression.free_symbols - parameters
    )
