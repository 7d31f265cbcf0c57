"""Runs inside another tool's environment: one machine in, seconds and A out.

Reads a topology as JSON from standard input (``nodes``: name, letter, value; ``bonds``:
tail, head), builds it with the tool named on the command line and prints JSON. Imports
nothing of this repository.
"""

import json
import sys
import time


def bondgraphtools(nodes: list, bonds: list) -> tuple[float, object]:
    import BondGraphTools as bgt  # noqa: N813, PLC0415

    begin = time.process_time()
    model = bgt.new(name="machine")
    made = {}
    for name, letter, value in nodes:
        given = {"value": value} if letter in {"I", "C", "R"} else {}
        made[name] = bgt.new(letter, **given)
        bgt.add(model, made[name])
    for tail, head in bonds:
        bgt.connect(made[tail], made[head])
    relations = model.constitutive_relations
    spent = time.process_time() - begin

    def matrix() -> list:
        import numpy as np  # noqa: PLC0415
        import sympy  # noqa: PLC0415

        owner = {id(component): name for name, component in made.items()}
        states = [owner[id(component)] for component, _ in model.state_vars.values()]
        x = sympy.symbols(f"x_0:{len(states)}")
        dx = sympy.symbols(f"dx_0:{len(states)}")
        rows = [relation.as_coefficients_dict() for relation in relations]
        mass = np.array([[float(row[s]) for s in dx] for row in rows])
        stiff = np.array([[float(row[s]) for s in x] for row in rows])
        order = [states.index(n) for n, k, _ in nodes if k in {"I", "C"}]
        A = -np.linalg.solve(mass, stiff)
        return A[np.ix_(order, order)].tolist()

    return spent, matrix


def karlinde(nodes: list, bonds: list) -> tuple[float, object]:
    from bondgraph import core, elements, junctions  # noqa: I001, PLC0415  (theirs)
    from bondgraph.common import Bond  # noqa: PLC0415
    from sympy import Symbol  # noqa: PLC0415

    begin = time.process_time()
    kinds = {"0": junctions.JunctionEqualEffort, "1": junctions.JunctionEqualFlow}
    made = {}
    for name, letter, _ in nodes:
        if letter in kinds:
            made[name] = kinds[letter](name)
        elif letter == "I":
            made[name] = elements.Element_I(name, Symbol(name), Symbol(f"x_{name}"))
        elif letter == "C":
            made[name] = elements.Element_C(name, Symbol(name), Symbol(f"x_{name}"))
        elif letter == "R":
            made[name] = elements.Element_R(name, Symbol(name))
        else:
            made[name] = elements.Source_effort(name, Symbol(name))
    graph = core.BondGraph()
    for tail, head in bonds:
        graph.add(Bond(made[tail], made[head]))
    equations = graph.get_state_equations()
    spent = time.process_time() - begin

    def matrix() -> list:
        values = {Symbol(n): v for n, k, v in nodes if k in {"I", "C", "R"}}
        states = [Symbol(f"x_{n}") for n, k, _ in nodes if k in {"I", "C"}]
        rows = [equations[x].xreplace(values).expand() for x in states]
        return [[float(row.coeff(x)) for x in states] for row in rows]

    return spent, matrix


TOOLS = {"BondGraphTools": bondgraphtools, "bondgraph": karlinde}


def main() -> None:
    topology = json.load(sys.stdin)
    tool = TOOLS[sys.argv[1]]
    tool(topology["warm"]["nodes"], topology["warm"]["bonds"])  # imports, first calls
    spent, matrix = tool(topology["nodes"], topology["bonds"])
    print(json.dumps({"seconds": spent, "A": matrix()}))


if __name__ == "__main__":
    main()
