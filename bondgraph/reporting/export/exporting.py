"""`export`: a model in another language; which one is an object.

Each target is a choice with its own options; the answer is the files to write.
"""

import json
from dataclasses import dataclass
from typing import assert_never

from bondgraph.choices import refuse_other
from bondgraph.equations.deriving.derivation import derive
from bondgraph.equations.rendering import as_latex
from bondgraph.errors import BondGraphError
from bondgraph.reporting.export.c99 import RESERVED as C_WORDS
from bondgraph.reporting.export.c99 import to_c99
from bondgraph.reporting.export.identifiers import Identifiers, identifier
from bondgraph.reporting.export.matlab import RESERVED as MATLAB_WORDS
from bondgraph.reporting.export.matlab import to_matlab
from bondgraph.reporting.export.modelica import RESERVED as MODELICA_WORDS
from bondgraph.reporting.export.modelica import to_modelica
from bondgraph.reporting.export.program import one_line
from bondgraph.reporting.export.python_control import to_python_control
from bondgraph.reporting.export.python_functions import to_python_functions
from bondgraph.reporting.model_text import to_python
from bondgraph.structure.graph import FinishedGraph


@dataclass(frozen=True, slots=True)
class C99:
    """A header and a source; ``name`` is the prefix of every public name."""

    name: str | None = None


@dataclass(frozen=True, slots=True)
class Matlab:
    """One function file for MATLAB and Octave, called ``name``."""

    name: str | None = None


@dataclass(frozen=True, slots=True)
class Modelica:
    """One Modelica class called ``name``."""

    name: str | None = None


@dataclass(frozen=True, slots=True)
class Latex:
    """The equations for reading, an ``aligned`` block."""


@dataclass(frozen=True, slots=True)
class PythonControl:
    """Python text that makes a python-control system called ``name``."""

    name: str | None = None


@dataclass(frozen=True, slots=True)
class PythonFunctions:
    """A Python module with the rates and outputs, free of bondgraph."""

    name: str | None = None


@dataclass(frozen=True, slots=True)
class PythonModel:
    """The Python text that makes the graph itself."""


@dataclass(frozen=True, slots=True)
class Json:
    """The matrices of the linear system with names and units."""


Target = (
    C99 | Matlab | Modelica | Latex | PythonControl | PythonFunctions | PythonModel
    | Json
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class ExportedFile:
    """One file of an export: what to call it, and its text."""

    name: str
    text: str


def export(graph: FinishedGraph, to: Target) -> tuple[ExportedFile, ...]:
    """Return a model in another language, as files to write.

    Parameters
    ----------
    graph
        The model; its parameter values become defaults that can be changed there.
    to
        The language, with its options.

    Raises
    ------
    CausalConflictError, EquationError
        If the graph has no equations, or they cannot be written in that language.
    ParameterError
        If numbers are needed and a parameter has no value.
    """
    refuse_other(to, Target, "The target of an export", BondGraphError)
    stem = _stem(graph, to)
    match to:
        case C99():
            header, source = to_c99(graph, name=stem)
            return (
                ExportedFile(f"{stem}.c", source),
                ExportedFile(f"{stem}.h", header),
            )
        case Matlab():
            return (ExportedFile(f"{stem}.m", to_matlab(graph, name=stem)),)
        case Modelica():
            return (ExportedFile(f"{stem}.mo", to_modelica(graph, name=stem)),)
        case Latex():
            return (ExportedFile(f"{stem}.tex", _latex(graph)),)
        case PythonControl():
            text = to_python_control(graph, name=to.name)
            return (ExportedFile(f"{stem}.py", text),)
        case PythonFunctions():
            return (ExportedFile(f"{stem}.py", to_python_functions(graph, name=stem)),)
        case PythonModel():
            return (ExportedFile(f"{stem}.py", to_python(graph)),)
        case Json():
            return (ExportedFile(f"{stem}.json", _json(graph)),)
        case _:
            assert_never(to)


def _stem(graph: FinishedGraph, to: Target) -> str:
    """Return the name of the files, which in some languages names what is in them."""
    words: dict[type, tuple[str, ...]] = {
        C99: C_WORDS,
        Matlab: MATLAB_WORDS,
        Modelica: MODELICA_WORDS,
    }
    name = getattr(to, "name", None) or graph.name
    return Identifiers(words.get(type(to), ())).new(identifier(name))


def _latex(graph: FinishedGraph) -> str:
    return (
        f"% {one_line(graph.name)}: state equations, for amsmath's display mode.\n"
        "% Written by bondgraph from the bond graph of that name.\n"
        f"{as_latex(derive(graph))}\n"
    )


def _json(graph: FinishedGraph) -> str:
    from bondgraph.numeric.state_space import state_space  # noqa: PLC0415  (numpy)

    system = state_space(graph)
    plain = {
        "schema": 1,
        "model": system.name,
        "states": list(system.states),
        "inputs": list(system.inputs),
        "outputs": list(system.outputs),
        "units": {
            "states": list(system.state_units),
            "inputs": list(system.input_units),
            "outputs": list(system.output_units),
        },
        **{letter: getattr(system, letter).tolist() for letter in "ABCD"},
    }
    return json.dumps(plain, indent=2, ensure_ascii=False) + "\n"
