"""Names of a model as names of a programming language, each once.

A name keeps its letters where the language allows them; Greek letters are spelled
out, accents dropped, what is left becomes an underscore. A word that the language
keeps for itself, or that two names share after all this, gets a number.
"""

import unicodedata
from collections.abc import Iterable

LONGEST = 60  # MATLAB and C99 tell the first 63 characters apart


class Identifiers:
    """Hands out identifiers; the same name under one role keeps its own.

    Parameters
    ----------
    reserved
        Words that may not be used.
    """

    def __init__(self, reserved: Iterable[str]) -> None:
        self._taken = set(reserved)

    def new(self, name: str) -> str:
        """Return an identifier for `name` that was not handed out before."""
        plain = identifier(name)
        found, number = plain, 2
        while found in self._taken:
            found, number = f"{plain}_{number}", number + 1
        self._taken.add(found)
        return found


def identifier(name: str) -> str:
    """Return `name` as a word of ASCII letters, digits and underscores.

    It begins with a letter, as MATLAB wants, and is never empty.
    """
    word = "_".join("".join(map(_ascii, name)).split()).strip("_")
    if not word or not word[0].isalpha():
        word = f"x{word}"
    # Underscores at the end tell names of the toolkit apart.
    end = len(name) - len(name.rstrip("_"))
    return word[:LONGEST] + "_" * min(end, 2)


def _ascii(character: str) -> str:
    if character == "_" or (character.isascii() and character.isalnum()):
        return character
    described = unicodedata.name(character, "").split()
    if described[:1] == ["GREEK"] and "LETTER" in described:
        word = described[described.index("LETTER") + 1].lower()
        return word.capitalize() if "CAPITAL" in described else word
    plain = unicodedata.normalize("NFKD", character)
    if plain == character:
        return "" if unicodedata.combining(character) else " "
    return "".join(map(_ascii, plain))
