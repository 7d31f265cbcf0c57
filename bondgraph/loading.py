"""Loading what a user names: ``file.py:name`` or ``package.module:name``.

A user's file may do anything while it is imported. Whatever goes wrong in it becomes
one line that says what and where, because a traceback through this package would show
the wrong code.
"""

import importlib
import importlib.util
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.machinery import SourceFileLoader
from inspect import signature
from pathlib import Path
from traceback import extract_tb
from types import CodeType, FunctionType, ModuleType

from bondgraph.errors import BondGraphError, ModelLoadError, did_you_mean
from bondgraph.structure.builder import BondGraph
from bondgraph.structure.graph import FinishedGraph

_GRAPH_NAMES = frozenset({"BondGraph", "FinishedGraph"})
_HOW = "Name a model as file.py:factory or package.module:factory."


def load_model(reference: str, *, directory: Path | None = None) -> FinishedGraph:
    """Return the finished graph that `reference` names, built afresh.

    Parameters
    ----------
    reference
        ``file.py:factory`` or ``package.module:factory``; the factory may be left out
        where the file has exactly one function that returns a `BondGraph`, or, with
        none annotated so, only one that can be called without arguments.
    directory
        Where relative files and modules are looked for; the working directory if None.

    Raises
    ------
    ModelLoadError
        If the file, module or factory is missing, fails, or returns something else.
    BondGraphError
        If the graph that the factory draws is not well formed.
    """
    module, name = _module_of(reference, directory)
    factory = _factory(module, name, reference)
    with _one_line_errors(reference, module.__file__):
        graph = factory()
        if isinstance(graph, BondGraph | FinishedGraph):
            return graph.finish()
    raise ModelLoadError(
        f"{reference!r} returns {_a(type(graph).__name__)}, not a BondGraph.",
        (reference,),
        "Let the factory return the BondGraph that it draws.",
    )


def load_object(reference: str, *, directory: Path | None = None) -> object:
    """Return the object that ``file.py:name`` or ``package.module:name`` names.

    Raises
    ------
    ModelLoadError
        If the file, module or name is missing, or its code fails.
    """
    module, name = _module_of(reference, directory)
    if name is None:
        raise ModelLoadError(
            f"{reference!r} names no object in its module.", (reference,), _HOW
        )
    return _attribute(module, name, reference)


def _module_of(reference: str, directory: Path | None) -> tuple[ModuleType, str | None]:
    """Return the imported module and the name behind the colon, if there is one."""
    where, colon, name = reference.strip().rpartition(":")
    if not colon or name.endswith(".py"):
        where, name = reference.strip(), ""
    if not where or (colon and not name and reference.strip().endswith(":")):
        raise ModelLoadError(f"{reference!r} names no model.", (reference,), _HOW)
    base = Path.cwd() if directory is None else directory.resolve()
    module = _from_file(base / where) if _is_file(where) else _from_path(where, base)
    return module, name or None


def _is_file(where: str) -> bool:
    return where.endswith(".py") or "/" in where or "\\" in where


def _from_file(path: Path) -> ModuleType:
    if not path.is_file():
        siblings = [p.name for p in path.parent.glob("*.py")]
        raise ModelLoadError(
            f"There is no file {str(path)!r}.",
            (str(path),),
            did_you_mean(path.name, siblings) if siblings else _HOW,
        )
    if path.suffix != ".py":
        raise ModelLoadError(f"{path.name!r} is not a Python file.", (str(path),), _HOW)
    name = f"_bondgraph_model_{path.stem}"
    loader = _Afresh(name, str(path))
    spec = importlib.util.spec_from_file_location(name, path, loader=loader)
    if spec is None or spec.loader is None:
        raise ModelLoadError(f"{str(path)!r} cannot be imported.", (str(path),), _HOW)
    module = importlib.util.module_from_spec(spec)
    with _one_line_errors(path.name, str(path)), _importable(path.parent):
        # Dataclasses and pickles look their module up by name, also later.
        sys.modules[name] = module
        spec.loader.exec_module(module)
    return module


class _Afresh(SourceFileLoader):
    """Compiles a file whatever bytecode there is.

    That is known by a file's length and second, and a number may be changed within one.
    """

    def get_code(self, fullname: str) -> CodeType:
        """Return the code of the file as it is now."""
        return self.source_to_code(self.get_data(self.path), self.path)


def _from_path(where: str, base: Path) -> ModuleType:
    with _one_line_errors(where, None), _importable(base):
        try:
            return importlib.import_module(where)
        except ModuleNotFoundError as error:
            # Only the module asked for: a missing import inside it is its own error.
            if error.name is None or not f"{where}.".startswith(f"{error.name}."):
                raise
    raise ModelLoadError(f"There is no module {where!r} here.", (where,), _HOW)


def _factory(
    module: ModuleType, name: str | None, reference: str
) -> Callable[[], object]:
    if name is not None:
        found = _attribute(module, name, reference)
        if not callable(found):
            raise ModelLoadError(
                f"{reference!r} is {_a(type(found).__name__)}, not a function.",
                (reference,),
                "Name a function that returns a BondGraph.",
            )
        return found
    factories = {f.__name__: f for f in _factories(module)}
    if not factories:
        # One that says nothing of what it returns can only be it where it is alone.
        silent = {f.__name__: f for f in _own(module) if _asks_nothing(f)}
        factories = silent if len(silent) == 1 else {}
    if len(factories) == 1:
        return next(iter(factories.values()))
    if factories:
        choices = ", ".join(sorted(factories))
        raise ModelLoadError(
            f"{reference!r} has {len(factories)} models: {choices}.",
            (reference, *sorted(factories)),
            f"Write {reference}:{min(factories)} for one of them.",
        )
    raise ModelLoadError(
        f"{reference!r} has no function that returns a BondGraph.",
        (reference,),
        "Annotate the factory, def machine() -> BondGraph, or name it after a colon.",
    )


def _factories(module: ModuleType) -> Iterator[FunctionType]:
    """Yield the module's own public functions annotated to return a graph."""
    for function in _own(module):
        returns = function.__annotations__.get("return")
        named = getattr(returns, "__name__", "")
        word = returns if isinstance(returns, str) else named
        if word.rpartition(".")[2] in _GRAPH_NAMES:
            yield function


def _own(module: ModuleType) -> Iterator[FunctionType]:
    """Yield the public functions that the module itself defines."""
    for name, member in vars(module).items():
        if not isinstance(member, FunctionType) or name.startswith("_"):
            continue
        if member.__module__ == module.__name__:
            yield member


def _asks_nothing(function: FunctionType) -> bool:
    """Return whether a function can be called without arguments, and says no type."""
    if "return" in function.__annotations__:
        return False
    needed = signature(function).parameters.values()
    return all(
        one.default is not one.empty
        or one.kind in (one.VAR_POSITIONAL, one.VAR_KEYWORD)
        for one in needed
    )


def _attribute(module: ModuleType, name: str, reference: str) -> object:
    try:
        return getattr(module, name)
    except AttributeError:
        names = [f.__name__ for f in _factories(module)] or [
            n for n in vars(module) if not n.startswith("_")
        ]
        raise ModelLoadError(
            f"There is no {name!r} in {reference.rpartition(':')[0]!r}.",
            (reference, name),
            did_you_mean(name, names),
        ) from None


@contextmanager
def _one_line_errors(what: str, file: str | None) -> Iterator[None]:
    """Turn whatever the user's code raises into a `ModelLoadError` naming its line."""
    try:
        yield
    except BondGraphError:
        raise  # already one clear line about the graph
    except SyntaxError as error:
        where = Path(error.filename or what).name
        line = f", line {error.lineno}" if error.lineno else ""
        raise ModelLoadError(
            f"{where}{line}: {error.msg}.",
            (what,),
            "Correct the syntax.",
        ) from error
    except (KeyboardInterrupt, GeneratorExit):
        raise  # the user's own wish
    except BaseException as error:  # what a model raises need be no Exception
        raise ModelLoadError(
            f"{_line(error, file) or what}: {_said(error)}.",
            (what,),
            "Correct the model's code.",
        ) from error


def _line(error: BaseException, file: str | None) -> str:
    """Return ``name.py, line n`` of the deepest frame in `file`, else of the last."""
    frames = [f for f in extract_tb(error.__traceback__) if f.filename != __file__]
    own = [f for f in frames if f.filename == file]
    frame = (own or [f for f in frames if not f.filename.startswith("<")])[-1:]
    return f"{Path(frame[0].filename).name}, line {frame[0].lineno}" if frame else ""


def _said(error: BaseException) -> str:
    """Return the error's kind and words on one line."""
    try:
        words = " ".join(str(error).split()).rstrip(".")
    except Exception:  # its class is the user's code as well
        words = ""
    kind = type(error).__name__
    return f"{kind}: {words}" if words else kind


def _a(noun: str) -> str:
    return (
        "None"
        if noun == "NoneType"
        else f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"
    )


@contextmanager
def _importable(directory: Path) -> Iterator[None]:
    """Let code import its neighbours, as ``python file.py`` would."""
    entry = str(directory)
    sys.path.insert(0, entry)
    importlib.invalidate_caches()
    try:
        yield
    finally:
        sys.path.remove(entry)
