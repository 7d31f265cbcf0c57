"""Sorting: from one definition per wire to a list in evaluation order.

Equal and opposite wires are replaced by what they equal. Tarjan's algorithm puts the
rest in order; a strongly connected component is an algebraic loop and is torn: one of
its wires becomes an unknown, preferably the output of a resistance whose causality was
a free choice, until no loop is left. Everything is iterative and linear for chains.
"""

from collections.abc import Iterable, Mapping

import sympy

from bondgraph.equations.deriving.definitions import Definition

MANY = 32

Graph = Mapping[sympy.Symbol, tuple[sympy.Symbol, ...]]


def without_aliases(
    given: Mapping[sympy.Symbol, Definition],
) -> tuple[dict[sympy.Symbol, Definition], dict[sympy.Symbol, sympy.Expr]]:
    """Return the definitions with equal wires replaced, and what they were replaced by.

    An alias is a wire defined as a number, a symbol, or a symbol with a minus sign. A
    ring of aliases keeps one definition, so that it shows as a loop.
    """
    aliases: dict[sympy.Symbol, sympy.Expr] = {}
    kept: dict[sympy.Symbol, Definition] = {}
    for symbol, definition in given.items():
        target = _resolved(definition.expression, aliases)
        if _is_atomic(target) and symbol not in target.free_symbols:
            aliases[symbol] = target
        else:
            kept[symbol] = definition
    aliases = {symbol: _resolved(target, aliases) for symbol, target in aliases.items()}
    return (
        {
            symbol: Definition(
                symbol,
                replaced(definition.expression, aliases),
                definition.origin,
                definition.reason,
            )
            for symbol, definition in kept.items()
        },
        aliases,
    )


def _is_atomic(expression: sympy.Expr) -> bool:
    if expression.is_Mul:  # compared, not negated: that would multiply a sum out
        return len(expression.args) == 2 and (
            expression.args[0] == -1 and expression.args[1].is_Symbol
        )
    return bool(expression.is_Symbol or expression.is_Number)


def _resolved(
    expression: sympy.Expr, aliases: dict[sympy.Symbol, sympy.Expr]
) -> sympy.Expr:
    """Follow a chain of aliases to its end, and let all of it point there."""
    path: list[tuple[sympy.Symbol, int]] = []
    here, sign = expression, 1
    while _is_atomic(here) and here.free_symbols:
        (symbol,) = here.free_symbols
        sign *= 1 if here.is_Symbol else -1
        here = aliases.get(symbol, symbol)
        if here is symbol:
            break
        path.append((symbol, sign))
    for symbol, sign_there in path:
        aliases[symbol] = here if sign == sign_there else -here
    return here if sign > 0 else -here


def replaced(
    expression: sympy.Expr, by: Mapping[sympy.Symbol, sympy.Expr]
) -> sympy.Expr:
    """Return `expression` with symbols replaced, touching only those that occur."""
    found = {s: by[s] for s in expression.free_symbols if s in by}
    return expression.xreplace(found) if found else expression


def dependencies(expressions: Mapping[sympy.Symbol, sympy.Expr]) -> Graph:
    """Return for each symbol those of the others that its expression reads, in order.

    The order is that of `expressions`, so that results do not depend on hashing.
    """
    place = {symbol: i for i, symbol in enumerate(expressions)}
    return {
        symbol: tuple(
            sorted(
                (s for s in expression.free_symbols if s in place),
                key=place.__getitem__,
            )
        )
        for symbol, expression in expressions.items()
    }


def components(
    graph: Graph, roots: Iterable[sympy.Symbol], cut: set[sympy.Symbol]
) -> list[list[sympy.Symbol]]:
    """Return the strongly connected components, each after those it depends on.

    Symbols in `cut` count as leaves: nothing is followed through them.
    """
    number: dict[sympy.Symbol, int] = {}
    low: dict[sympy.Symbol, int] = {}
    stack: list[sympy.Symbol] = []
    on_stack: set[sympy.Symbol] = set()
    found: list[list[sympy.Symbol]] = []
    outside = {s for reads in graph.values() for s in reads if s not in graph} | cut

    def enter(node: sympy.Symbol) -> None:
        number[node] = low[node] = len(number)
        stack.append(node)
        on_stack.add(node)

    for root in roots:
        if root in number or root in outside:
            continue
        enter(root)
        path = [(root, iter(graph[root]))]
        while path:
            node, successors = path[-1]
            for successor in successors:
                if successor in outside:
                    continue
                if successor not in number:
                    enter(successor)
                    path.append((successor, iter(graph[successor])))
                    break
                if successor in on_stack:
                    low[node] = min(low[node], number[successor])
            else:
                path.pop()
                parent = path[-1][0] if path else node
                low[parent] = min(low[parent], low[node])
                if low[node] == number[node]:
                    found.append(_popped(stack, on_stack, node))
    return found


def _popped(
    stack: list[sympy.Symbol], on_stack: set[sympy.Symbol], until: sympy.Symbol
) -> list[sympy.Symbol]:
    members = []
    while True:
        member = stack.pop()
        on_stack.discard(member)
        members.append(member)
        if member == until:
            return members


def cut_loops(
    graph: Graph, preferred: Iterable[sympy.Symbol]
) -> tuple[list[sympy.Symbol], dict[sympy.Symbol, tuple[sympy.Symbol, ...]]]:
    """Return the symbols in evaluation order, and each cut one with its loop.

    Parameters
    ----------
    preferred
        Symbols to cut first, where they lie in a loop.
    """
    liked = set(preferred)
    cut: dict[sympy.Symbol, tuple[sympy.Symbol, ...]] = {}
    pending = [
        loop for loop in components(graph, graph, set()) if _is_loop(graph, loop)
    ]
    while pending:
        loop = pending.pop()
        chosen = [s for s in loop if s in liked] or [_busiest(graph, loop)]
        # One at a time, since one may open the loop of another; of many a part at a
        # time, so that the cost stays near linear.
        chosen = chosen[: 1 + len(chosen) // MANY]
        cut.update(dict.fromkeys(chosen, tuple(loop)))
        members = set(loop)
        inside = {s: tuple(d for d in graph[s] if d in members) for s in loop}
        rest = components(inside, loop, set(cut))
        pending.extend(part for part in rest if _is_loop(inside, part))
    order = [s for (s,) in components(graph, graph, set(cut))]
    return order, cut


def _is_loop(graph: Graph, component: list[sympy.Symbol]) -> bool:
    return len(component) > 1 or component[0] in graph[component[0]]


def _busiest(graph: Graph, loop: list[sympy.Symbol]) -> sympy.Symbol:
    """Return the member that most others of the loop read."""
    readers = dict.fromkeys(loop, 0)
    for member in loop:
        for read in graph[member]:
            if read in readers:
                readers[read] += 1
    return max(loop, key=lambda s: readers[s])
