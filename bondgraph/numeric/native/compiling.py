"""Native code of a tape, ready in milliseconds: LLVM compiles its assembly.

LLVM comes with numba; nothing is written to disk. Equal tapes are compiled once per
process, whatever models they belong to. A tape has no common subexpressions left, so
that optimising its code makes it a fifth faster at best, and ready twenty times later:
that is for long simulations.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

from bondgraph.numeric.native.code import Assembly, Function, Writer
from bondgraph.numeric.native.functions import declarations
from bondgraph.numeric.tape import Tape

KEPT = 256
"""How many compiled texts a process keeps."""


@dataclass(frozen=True, slots=True, eq=False)
class NativeCode:
    """Compiled functions.

    Parameters
    ----------
    address
        Where each function starts, by name; 0 for what the text does not define.
    keeper
        Owns the code, which is freed with this object.
    """

    addresses: Mapping[str, int]
    keeper: Any

    def __getitem__(self, name: str) -> int:
        return self.addresses.get(name, 0)


@lru_cache(maxsize=KEPT)
def compiled_text(text: str, *, optimised: bool = False) -> NativeCode:
    """Compile LLVM assembly; equal texts are compiled once."""
    keeper = _machine_code(text, 2 if optimised else 0)
    names = re.findall(r"^define void @(\w+)\(", text, re.MULTILINE)
    return NativeCode({n: keeper.get_function_address(n) for n in names}, keeper)


def module_text(functions: Sequence[Function], lanes: int = 1) -> str:
    """Return the assembly of functions and of what they call."""
    called = set().union(*(function.called for function in functions))
    lines = [line for function in functions for line in function.lines]
    return "\n".join([*declarations(called, lanes), *lines])


def values_of(tape: Tape, name: str, lanes: int = 1) -> Function:
    """Return ``void name(double *v)``: variables in, results out.

    Result i follows the variables, ``v[n_variables + i]``. With lanes, slot s of lane k
    lies at ``v[s * lanes + k]``.
    """
    code = Assembly(lanes)
    writer = _started(tape, code)
    return _function(code, name, "ptr noalias %v", _results(writer))


def slopes_of(tape: Tape, name: str, columns: Sequence[int]) -> Function:
    """Return ``void name(double *v, double *j)``: results and their slopes.

    The derivative of result i along the variable ``columns[k]`` goes to
    ``j[i * len(columns) + k]``, where it is not zero at every point.
    """
    code = Assembly()
    writer = _started(tape, code)
    writer.write_rows(columns)
    stores = [*_results(writer), *_matrix(writer, len(columns))]
    return _function(code, name, "ptr noalias %v, ptr noalias %j", stores)


def _function(
    code: Assembly, name: str, arguments: str, stores: Sequence[str]
) -> Function:
    head = f"define void @{name}({arguments}) nounwind {{"
    return Function([head, *code.lines, *stores, "  ret void", "}"], code.called)


def _started(tape: Tape, code: Assembly) -> Writer:
    """Load the variables and write all values."""
    used = {slot for operation in tape.code.tolist() for slot in operation[1:]}
    used |= set(tape.outputs.tolist())
    for i in sorted(slot for slot in used if slot < tape.n_variables):
        code.lines.append(f"  %pv{i} = getelementptr {code.real}, ptr %v, i64 {i}")
        code.lines.append(f"  %v{i} = load {code.real}, ptr %pv{i}, align 8")
    writer = Writer(tape, code, [f"%v{i}" for i in range(tape.n_variables)])
    writer.write_values()
    return writer


def _results(writer: Writer) -> list[str]:
    tape = writer.tape
    values = [writer.values[slot] for slot in tape.outputs.tolist()]
    return _stores(writer.code.real, "%v", dict(enumerate(values, tape.n_variables)))


def _matrix(writer: Writer, n_columns: int) -> list[str]:
    entries = {
        i * n_columns + k: slope
        for i, slot in enumerate(writer.tape.outputs.tolist())
        for k, slope in writer.rows[slot].items()
    }
    return _stores(writer.code.real, "%j", entries)


def _stores(real: str, base: str, entries: dict[int, str]) -> list[str]:
    lines = []
    for i, value in entries.items():
        lines.append(f"  {base}p{i} = getelementptr {real}, ptr {base}, i64 {i}")
        lines.append(f"  store {real} {value}, ptr {base}p{i}, align 8")
    return lines


def _machine_code(text: str, level: int) -> Any:
    """Compile assembly for this processor; return the engine that owns the code."""
    import llvmlite.binding as llvm  # type: ignore[import-untyped]  # noqa: PLC0415

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    module = llvm.parse_assembly(text)
    machine = llvm.Target.from_default_triple().create_target_machine(
        opt=level,
        jit=True,
        **_this_processor(),
    )
    options = llvm.create_pipeline_tuning_options(speed_level=level)
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.finalize_object()
    return engine


@cache
def _this_processor() -> dict[str, str]:
    """Return name and features of the processor; asking takes a millisecond."""
    import llvmlite.binding as llvm  # noqa: PLC0415

    features = llvm.get_host_cpu_features().flatten()
    return {"cpu": llvm.get_host_cpu_name(), "features": features}
