r"""Names of a model as LaTeX: ``p_I_motor`` as :math:`p_{\mathrm{I\,motor}}`.

What stands before the first underscore is the letter, what follows its index. Words of
several letters are upright, Greek ones are letters, digits at the end of a letter are
an index of it, and whatever TeX would take for a command is escaped.
"""

import re
import unicodedata
from collections.abc import Iterable, Mapping

import sympy
from sympy.printing.latex import greek_letters_set, tex_greek_dictionary

_ESCAPES = {
    **{c: rf"\{c}" for c in "#$%&_{}"},
    "\\": r"\backslash ", "~": r"\sim ", "^": r"\wedge ", "'": r"\prime ",
    '"': r"\prime\prime ", "`": r"\prime ",
}  # fmt: skip
THIN = r"\,"
_PARTS = re.compile(r"[^\W\d_]+\d*|\d+|.", re.DOTALL)


def latex(
    expression: sympy.Basic, rates: Mapping[sympy.Symbol, sympy.Symbol] | None = None
) -> str:
    """Return an expression as LaTeX with readable names.

    Parameters
    ----------
    expression
        An expression of the model's symbols.
    rates
        For each symbol that is a rate, what it is the rate of: it is shown by a dot.
    """
    dotted = rates or {}
    names = {
        symbol: latex_name(dotted[symbol].name, accent=r"\dot")
        if symbol in dotted
        else latex_name(symbol.name)
        for symbol in expression.free_symbols
    }
    text: str = sympy.latex(expression, symbol_names=names)
    return text


def latex_name(name: str, *, accent: str = "") -> str:
    r"""Return a name as LaTeX; `accent` is a command over its letter, as ``\dot``."""
    bare = name.strip("_")
    primes = "'" * (len(name) - len(name.rstrip("_")))
    letter, *words = [word for word in bare.split("_") if word] or [""]
    head = _word(letter)
    indices = list(words)
    match = re.fullmatch(r"([^\W\d_]|[^\W\d_]+(?=\d))(\d+)", letter)
    if match is not None:
        head, indices = _word(match[1]), [match[2], *words]
    if accent:
        head = f"{accent}{{{head}}}"
    index = _index(indices)
    return f"{head}{f'_{{{index}}}' if index else ''}{primes}"


def _index(words: Iterable[str]) -> str:
    words = list(words)
    if len(words) > 1 and all(_upright(word) for word in words):
        return rf"\mathrm{{{THIN.join(words)}}}"
    return THIN.join(map(_word, words))


def _upright(word: str) -> bool:
    return word.isascii() and word.isalpha() and word not in greek_letters_set


def _word(word: str) -> str:
    """Return one word: a letter, a Greek letter, an upright word, or its parts."""
    greek = _greek(word)
    if greek:
        return greek
    if word.isascii() and word.isalpha():
        return word if len(word) == 1 else rf"\mathrm{{{word}}}"
    if word.isascii() and word.isdigit():
        return word
    parts = _PARTS.findall(word)
    if len(parts) > 1:
        return "".join(map(_word, parts))
    match = re.fullmatch(r"([^\W\d_]+)(\d+)", word)
    if match is not None:
        return f"{_word(match[1])}_{{{match[2]}}}"
    if word.isspace() or not word.isprintable():
        return r"\ "
    return _ESCAPES.get(word, word)


def _greek(word: str) -> str:
    """Return the command of a Greek letter, spelled out or as itself."""
    described = unicodedata.name(word, "").split() if len(word) == 1 else []
    if described[:1] == ["GREEK"] and len(described) == 4:
        spelled = described[3].lower().replace("lamda", "lambda")
        word = spelled.capitalize() if described[1] == "CAPITAL" else spelled
    if word in tex_greek_dictionary:
        return str(tex_greek_dictionary[word])
    return f"\\{word}" if word in greek_letters_set else ""
