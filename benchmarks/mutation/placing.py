"""A mutant put in the place of its module.

Where the change is inside a function, the function that is there already is given the
other code: then nothing has to be imported anew, and no test collected. Where it is not
(a constant of the module, a default, a class), the module is imported with the change.
"""

import ast
import gc
import sys
from collections.abc import Iterator
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import spec_from_loader
from pathlib import Path
from types import CodeType, FunctionType, ModuleType

from benchmarks.mutation.mutants import Mutant, mutated

Place = tuple[str, int]


def is_inside_function(mutant: Mutant) -> bool:
    """Return whether the change is in the body of a function."""
    tree = ast.parse(Path(mutant.path).read_text(encoding="utf-8"))
    node = next(n for i, n in enumerate(ast.walk(tree)) if i == mutant.node)
    return any(
        inner is node
        for function in ast.walk(tree)
        if isinstance(function, ast.FunctionDef)
        for statement in function.body
        for inner in ast.walk(statement)
    )


def give_other_code(mutant: Mutant) -> None:
    """Give every function of the module that is there the code of the mutant.

    Wrapped ones and methods as well, wherever they are referred to from.
    """
    file = str(Path(mutant.path).resolve())
    whole = compile(mutated(mutant), file, "exec")
    others = {_place(code): code for code in _codes(whole)}
    functions = [
        f
        for f in gc.get_objects()
        if isinstance(f, FunctionType) and f.__code__.co_filename == file
    ]
    if not functions:
        raise LookupError(f"No function of {mutant.path} has been imported.")
    for function in functions:
        function.__code__ = others[_place(function.__code__)]


def import_instead(mutant: Mutant) -> None:
    """Have the mutant imported in place of its module, which is not imported yet."""
    sys.meta_path.insert(0, _Finder(mutant))


def _place(code: CodeType) -> Place:
    return code.co_qualname, code.co_firstlineno


def _codes(code: CodeType) -> Iterator[CodeType]:
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield constant
            yield from _codes(constant)


class _Finder(MetaPathFinder):
    """Finds the mutant's module, and nothing else."""

    def __init__(self, mutant: Mutant) -> None:
        self.mutant = mutant
        self.name = mutant.path.removesuffix(".py").replace("/", ".")

    def find_spec(
        self, name: str, path: object = None, target: object = None
    ) -> ModuleSpec | None:
        """Return where the mutant's module comes from."""
        if name != self.name:
            return None
        return spec_from_loader(name, _Mutated(self.mutant), origin=self.mutant.path)


class _Mutated(Loader):
    """Executes the mutant's tree as the module."""

    def __init__(self, mutant: Mutant) -> None:
        self.mutant = mutant

    def exec_module(self, module: ModuleType) -> None:
        """Execute the module with the change made."""
        module.__file__ = str(Path(self.mutant.path).resolve())
        exec(compile(mutated(self.mutant), module.__file__, "exec"), module.__dict__)
