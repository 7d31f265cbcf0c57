"""Mutants: a module with one small thing wrong in it.

The operators are those that tell most for their price (Offutt, Lee, Rothermel, Untch
and Zapf, ACM TOSEM 5, 1996: relational, logical and arithmetic replacement, constants)
with statements left out. Docstrings, annotations, assertions and the texts of messages
are not mutated: nobody tests whether an assertion that never fails fails.
"""

import ast
from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass
from pathlib import Path

COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}
ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Div,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
NAMES = {"min": "max", "max": "min", "any": "all", "all": "any"}


Change = tuple[str, ast.AST]
"""What is made wrong, in words, and the node that is there instead."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change: where, what was there, and what is there instead.

    ``node`` counts the nodes of the module's tree in the order of `ast.walk`, and
    ``part`` the changes to that node.
    """

    path: str
    line: int
    column: int
    node: int
    part: int
    change: str

    @property
    def name(self) -> str:
        """A name that stays while the file does."""
        return f"{self.path}:{self.line}:{self.column} {self.change}"


def mutants_of(path: Path) -> list[Mutant]:
    """Return every mutant of the module at `path`."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    left_alone = set(_left_alone(tree))
    return [
        Mutant(str(path), node.lineno, node.col_offset, index, part, words)
        for index, node in enumerate(ast.walk(tree))
        if isinstance(node, ast.expr | ast.stmt) and id(node) not in left_alone
        for part, (words, _) in enumerate(_changes(node))
    ]


def mutated(mutant: Mutant) -> ast.Module:
    """Return the tree of a mutant's module with the change made."""
    tree = ast.parse(Path(mutant.path).read_text(encoding="utf-8"))
    node = next(n for i, n in enumerate(ast.walk(tree)) if i == mutant.node)
    _, new = list(_changes(node))[mutant.part]
    _replace(tree, node, ast.copy_location(new, node))
    return ast.fix_missing_locations(tree)


def _changes(node: ast.AST) -> Iterator[Change]:
    yield from _other_operators(node)
    yield from _other_values(node)
    yield from _other_ways(node)


def _with(node: ast.AST, **fields: object) -> ast.AST:
    changed = copy(node)
    for name, value in fields.items():
        setattr(changed, name, value)
    return changed


def _other_operators(node: ast.AST) -> Iterator[Change]:
    match node:
        case ast.Compare(ops=ops):
            for i, op in enumerate(ops):
                other = COMPARISONS[type(op)]
                words = f"{type(op).__name__} → {other.__name__}"
                yield words, _with(node, ops=[*ops[:i], other(), *ops[i + 1 :]])
        case ast.BinOp(op=op) | ast.AugAssign(op=op) if type(op) in ARITHMETIC:
            changed = ARITHMETIC[type(op)]
            words = f"{type(op).__name__} → {changed.__name__}"
            yield words, _with(node, op=changed())
        case ast.BoolOp(op=ast.And()):
            yield "and → or", _with(node, op=ast.Or())
        case ast.BoolOp():
            yield "or → and", _with(node, op=ast.And())
        case ast.UnaryOp(op=ast.Not() | ast.USub(), operand=operand):
            yield f"without {type(node.op).__name__}", operand


def _other_values(node: ast.AST) -> Iterator[Change]:
    match node:
        case ast.Constant(value=bool(value)):
            yield f"{value} → {not value}", _with(node, value=not value)
        case ast.Constant(value=int() | float() as value):
            yield f"{value} → {value + 1}", _with(node, value=value + 1)
        case ast.Name(id=name, ctx=ast.Load()) if name in NAMES:
            yield f"{name} → {NAMES[name]}", _with(node, id=NAMES[name])


def _other_ways(node: ast.AST) -> Iterator[Change]:
    match node:
        case ast.If(test=test) | ast.IfExp(test=test) | ast.While(test=test):
            negated = ast.UnaryOp(ast.Not(), test)
            yield "condition → not condition", _with(node, test=negated)
        case ast.Expr(value=ast.Call() | ast.Yield() | ast.YieldFrom()) | ast.Delete():
            yield "statement left out", ast.Pass()
        case ast.Continue():
            yield "continue → break", ast.Break()
        case ast.Break():
            yield "break → continue", ast.Continue()


def _replace(tree: ast.Module, old: ast.AST, new: ast.AST) -> None:
    for parent in ast.walk(tree):
        for name, value in ast.iter_fields(parent):
            if value is old:
                setattr(parent, name, new)
            elif isinstance(value, list):
                value[:] = [new if item is old else item for item in value]


def _left_alone(tree: ast.Module) -> Iterator[int]:
    """Yield the nodes of annotations, decorators, assertions and messages."""
    for node in ast.walk(tree):
        inner: list[ast.AST | None] = []
        match node:
            case ast.arg() | ast.AnnAssign():
                inner = [node.annotation]
            case ast.FunctionDef():
                inner = [node.returns, *node.decorator_list]
            case ast.ClassDef():
                inner = [*node.decorator_list]
            case ast.Assert() | ast.JoinedStr() | ast.keyword(arg="strict"):
                inner = [node]  # strict: that two lists are equally long
            case ast.If(test=ast.Name(id="TYPE_CHECKING")):
                inner = [node]
            case ast.Assign(value=ast.Subscript() as value) if node in tree.body:
                inner = [value]  # a name for a type
        yield from (id(n) for part in inner if part is not None for n in ast.walk(part))
