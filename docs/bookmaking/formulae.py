"""A law as a reader writes it: short letters, parameters without the place's name."""

from dataclasses import dataclass

import sympy

from bondgraph.equations.latex_names import latex_name
from bondgraph.structure.domains import Quantity
from bondgraph.structure.signals import Signal, signals_in
from bookmaking.scenes import Scene
from bookmaking.staging import Play

LETTERS = {"effort": "e", "flow": "f", "momentum": "p", "displacement": "q"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Formula:
    """A law as LaTeX.

    Parameters
    ----------
    block
        The law, and the rates of the states it brings, aligned.
    letters
        What each letter in it stands for, as LaTeX and Markdown.
    """

    block: str
    letters: dict[str, str]


def formula(shown: Play, scene: Scene) -> Formula:
    """Return the law of a play."""
    law = shown.hypothesis
    states = getattr(law.edit, "states", ())
    memory = _numbered(len(states))
    parts = (law.law, *(state.rate for state in states))
    remembered = {s.value: z for s, z in zip(states, memory, strict=True)}
    read = {s: _letter(s, shown, scene) for x in parts for s in signals_in(x)}
    named = {
        **{
            sympy.Symbol(p.name, real=True): p.name.removesuffix(f"_{scene.place}")
            for p in law.edit.parameters
        },
        **read,
        **remembered,
    }
    short = {old: sympy.Symbol(new, real=True) for old, new in named.items()}
    law_side, *rates = (_latex(_rounded(x.xreplace(short))) for x in parts)
    law_side = scene.written or law_side
    left = scene.left or LETTERS[scene.up.removeprefix("-").partition("(")[0]]
    lines = [f"{left} &= {law_side}"]
    lines += [rf"\dot{{{z}}} &= {x}" for z, x in zip(memory, rates, strict=True)]
    body = " \\\\\n".join(lines)
    letters = {
        letter: f"the {domain_at(shown, law.element).word(Quantity(quantity))} there"
        for quantity, letter in LETTERS.items()
        if sympy.Symbol(letter, real=True) in law.law.free_symbols
    }
    for signal, letter in read.items():
        if signal not in remembered:
            letters[latex_name(letter)] = _meaning(signal, letter, shown)
    letters |= dict.fromkeys(memory, "a state that it brings")
    return Formula(block=f"\\begin{{align*}}\n{body}\n\\end{{align*}}", letters=letters)


def _latex(expression: sympy.Expr) -> str:
    """Return an expression with its names as the field writes them, apart by a gap."""
    names = {symbol: latex_name(symbol.name) for symbol in expression.free_symbols}
    text: str = sympy.latex(expression, symbol_names=names, mul_symbol=r" \, ")
    return text


def _rounded(expression: sympy.Expr) -> sympy.Expr:
    """Return an expression whose decimals can be read."""
    return expression.xreplace(
        {x: sympy.Float(x, 4) for x in expression.atoms(sympy.Float)}
    )


def _numbered(count: int) -> tuple[str, ...]:
    """Return the letters of states."""
    return ("z",) if count == 1 else tuple(f"z_{i + 1}" for i in range(count))


def _letter(signal: Signal, shown: Play, scene: Scene) -> str:
    """Return the letter of a signal: plain at the place itself, with an index else."""
    if scene.place in {source.name for source in shown.without.inputs}:
        return "u"
    if scene.place in {m.name for m in shown.without.measurements}:
        return "x"
    letter = LETTERS[signal.quantity.value]
    if signal.place in (scene.place, shown.hypothesis.element):
        return letter
    return f"{letter}_{signal.place.rpartition('>')[2]}"


def _meaning(signal: Signal, letter: str, shown: Play) -> str:
    if letter == "u":
        return "what is commanded"
    if letter == "x":
        return "what is there"
    word = domain_at(shown, signal.place).word(signal.quantity)
    return f"the {word} at `{signal.place.rpartition('>')[2]}`"


def domain_at(shown: Play, place: str):  # type: ignore[no-untyped-def]
    """Return the energy domain at an element, junction or bond of the whole model."""
    return shown.complete.domain_at(place.partition(">")[0])
