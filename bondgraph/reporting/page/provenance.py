"""How an answer was computed, as rows of name and text."""

from collections.abc import Iterator, Mapping

HASH = "sha256"


def provenance_rows(value: object, name: str = "") -> Iterator[tuple[str, str]]:
    """Yield nested provenance as rows of name and text.

    A recording is told by its name and hash in one row.
    """
    if isinstance(value, Mapping):
        if set(value) == {"name", HASH}:
            yield f"{name} / {value['name']}", f"{HASH} {value[HASH]}"
            return
        for key, item in value.items():
            yield from provenance_rows(item, f"{name} / {key}" if name else str(key))
    elif isinstance(value, tuple | list):
        if any(isinstance(item, Mapping) for item in value):
            for item in value:
                yield from provenance_rows(item, name)
        else:
            yield name, ", ".join(str(item) for item in value)
    else:
        yield name, str(value)
