"""One step of the classical Runge-Kutta method as straight-line native code.

The four stages are written out one after another, so that states stay in registers and
what depends on parameters alone is computed once.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from bondgraph.numeric.native.code import Assembly, Function, Row, Writer
from bondgraph.numeric.tape import Tape

NODES = (0.0, 0.5, 0.5, 1.0)
WEIGHTS = (1.0, 2.0, 2.0, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Sizes:
    """Numbers of states, inputs and parameters of an explicit model."""

    states: int
    inputs: int
    parameters: int

    @property
    def first_input(self) -> int:
        """The slot of the first input; x, ẋ lie before it."""
        return 2 * self.states

    @property
    def first_parameter(self) -> int:
        """The slot of the first parameter; u, u̇ lie before it."""
        return self.first_input + 2 * self.inputs

    @property
    def time(self) -> int:
        """The slot of the time; elapsed time and step size follow it."""
        return self.first_parameter + self.parameters


@dataclass(frozen=True, slots=True)
class Stages:
    """Registers of the slopes of each stage, their rows, and the new states."""

    rows: list[list[Row]]
    new: list[str]
    half: str
    h: str
    sixth: str


def step_body(
    code: Assembly, tape: Tape, sizes: Sizes, columns: Sequence[int]
) -> Stages:
    """Write the four stages; slopes along `columns` (none: leave them out)."""
    x = [load(code, "%v", i) for i in range(sizes.states)]
    at = sizes.first_input
    u = [load(code, "%v", at + i) for i in range(sizes.inputs)]
    du = [load(code, "%v", at + sizes.inputs + i) for i in range(sizes.inputs)]
    p = [load(code, "%v", sizes.first_parameter + i) for i in range(sizes.parameters)]
    t, elapsed, h = (load(code, "%v", sizes.time + i) for i in range(3))
    half = code.multiply(code.constant(0.5), h)
    sixth = code.multiply(code.constant(1.0 / 6.0), h)
    parts = {0.5: half, 1.0: h}
    k: list[str] = []
    total: list[str] = []
    rows = []
    for node, weight in zip(NODES, WEIGHTS, strict=True):
        here, since = x, elapsed
        if node:
            step = parts[node]
            here = [
                code.add(a, code.multiply(step, b)) for a, b in zip(x, k, strict=True)
            ]
            since = code.add(elapsed, step)
        now = [code.add(a, code.multiply(b, since)) for a, b in zip(u, du, strict=True)]
        unused = [code.zero] * sizes.states
        writer = Writer(tape, code, [*here, *unused, *now, *du, *p, code.add(t, since)])
        writer.write_values()
        if columns:
            writer.write_rows(columns)
            rows.append([writer.rows[slot] for slot in tape.outputs.tolist()])
        k = [writer.values[slot] for slot in tape.outputs.tolist()]
        share = [code.multiply(code.constant(weight), a) for a in k]
        total = share if not total else list(map(code.add, total, share))
    new = [code.add(a, code.multiply(sixth, b)) for a, b in zip(x, total, strict=True)]
    return Stages(rows, new, half, h, sixth)


def load(code: Assembly, base: str, slot: int) -> str:
    """Write the load of one element."""
    at = code.write(f"getelementptr {code.real}, ptr {base}, i64 {slot}")
    return code.write(f"load {code.real}, ptr {at}, align 8")


def store(code: Assembly, base: str, slot: int, value: str) -> None:
    """Write the store of one element."""
    at = code.write(f"getelementptr {code.real}, ptr {base}, i64 {slot}")
    code.lines.append(f"  store {code.real} {value}, ptr {at}, align 8")


def step(tape: Tape, sizes: Sizes, lanes: int = 1) -> Function:
    """Return ``void step(double *v)``: x in `v` after one step, and what it calls."""
    code = Assembly(lanes)
    stages = step_body(code, tape, sizes, ())
    for i, value in enumerate(stages.new):
        store(code, "%v", i, value)
    head = "define void @step(ptr noalias %v) nounwind {"
    return Function([head, *code.lines, "  ret void", "}"], code.called)
