"""The cookbook: a page for every law of the library, from the library's own records."""

import re
from collections.abc import Iterator

from bondgraph import LIBRARY, to_python
from bondgraph.physics.descriptions import Description, describe
from bondgraph.physics.hypothesis import AbstractPhysics
from bondgraph.structure.domains import Quantity
from bookmaking.formulae import domain_at, formula
from bookmaking.scenes import SCENES, Scene
from bookmaking.signatures import course, curve
from bookmaking.staging import Play, forms, play


def pages() -> dict[str, str]:
    """Return the page of every law by its file name, and the page of all pictures."""
    found, pictures = {}, []
    for physics in LIBRARY:
        scene, words = SCENES[type(physics).__name__], describe(physics)
        if words is None:
            raise LookupError(f"Nothing is said of {type(physics).__name__}.")
        shown = play(physics, scene)
        law = curve(shown, _labels(shown, scene), cloud=scene.cloud)
        page = _page(physics, words, scene, shown, law)
        found[f"{slug(physics)}.md"] = "\n".join(page)
        pictures.append(
            f'<a href="generated/{slug(physics)}.html">'
            f"{law}<span>{words.title}</span></a>"
        )
    found["sheet.inc"] = _sheet(pictures)
    return found


def _sheet(pictures: list[str]) -> str:
    """Return all pictures as links, and the pages in the order of the library."""
    order = "\n".join(f"generated/{slug(physics)}" for physics in LIBRARY)
    drawn = "\n".join(pictures)
    return (
        f'```{{raw}} html\n<nav class="sheet" aria-label="All laws">\n{drawn}\n</nav>\n'
        f"```\n\n```{{toctree}}\n:hidden:\n\n{order}\n```\n"
    )


def slug(physics: AbstractPhysics) -> str:
    """Return the name of a law's page."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", type(physics).__name__).lower()


def _page(
    physics: AbstractPhysics, words: Description, scene: Scene, shown: Play, law: str
) -> Iterator[str]:
    yield f"# {words.title}\n"
    yield f"`{physics.word}`. {words.about}\n"
    yield "## The law\n"
    yield from _law(physics, shown, scene)
    yield "## Its signature\n"
    output = f"{_spoken(scene.output)} [{_unit(shown, scene.output)}]"
    yield "```{raw} html"
    yield f'<figure class="signature" role="img" aria-label="{_plain(words.look)}">'
    yield f"<div>{course(shown, output)}</div><div>{law}</div>"
    yield "</figure>\n```\n"
    yield f"{words.look} Grey is the machine without the law, red with it.\n"
    yield "## What it is taken for\n"
    yield from _confusions(words)
    yield "## An example\n"
    change = shown.hypothesis.edit.describe()
    yield f"The machine of the picture, with the law ({change}):\n"
    yield f"```python\n{to_python(shown.complete).strip()}\n```\n"
    yield f"A diagnosis says of it: *{shown.hypothesis.words}*.\n"
    yield "## Where to read on\n"
    yield from (f"- {source}" for source in words.sources)
    yield f"\nThe library says in short: {physics.reference}.\n"


def _law(physics: AbstractPhysics, shown: Play, scene: Scene) -> Iterator[str]:
    written = formula(shown, scene)
    yield f"$$\n{written.block}\n$$\n"
    if written.letters:
        said = ", ".join(f"${x}$ is {words}" for x, words in written.letters.items())
        yield f"{said[0].upper() if said[0] != '$' else said[0]}{said[1:]}.\n"
    if shown.hypothesis.edit.parameters:
        yield "| Parameter | In the example | Bounds | In a fit |"
        yield "| --- | --- | --- | --- |"
    for parameter in shown.hypothesis.edit.parameters:
        value = shown.complete.parameters[parameter.name].value
        stem = parameter.name.removesuffix(f"_{scene.place}")
        fitted = "held" if parameter.exact else "fitted"
        number = f"{value:.4g} {parameter.unit}".removesuffix(" 1")
        yield f"| `{stem}` | {number} | {_bounds(*parameter.bounds)} | {fitted} |"
    yield f"\n{physics.passivity.value}\n"
    said_by = dict.fromkeys(h.words for h in forms(physics, scene))
    if len(said_by) > 1:
        yield "At this place it is tried in several forms:\n"
        yield from (f"- {words}" for words in said_by)
        yield ""


def _bounds(low: float, high: float) -> str:
    ends = f"{low:.4g} to {high:.4g}".replace("inf", "∞").replace("-∞", "−∞")
    return "none" if ends == "−∞ to ∞" else ends


def _confusions(words: Description) -> Iterator[str]:
    by_name = {type(physics).__name__: physics for physics in LIBRARY}
    yield "| Taken for | When | What tells them apart |"
    yield "| --- | --- | --- |"
    for confusion in words.confusions:
        other = by_name[confusion.other]
        described = describe(other)
        title = described.title if described else confusion.other
        link = f"[{title}]({slug(other)}.md)"
        yield f"| {link} | {confusion.when} | {confusion.apart} |"
    if words.real:
        yield f"\nReal recordings that show the law: {words.real}."
    yield ""


def _plain(text: str) -> str:
    return text.replace("*", "").replace('"', "&quot;")


def _spoken(name: str) -> str:
    return name.replace("_", " ")


def _unit(shown: Play, output: str) -> str:
    return next(m.unit for m in shown.without.measurements if m.name == output)


def _labels(shown: Play, scene: Scene) -> tuple[str, str]:
    """Return what the axes of the law are called, in the words of its domain."""
    if any(scene.labels):
        return scene.labels
    return _axis(scene.across, shown), f"{_axis(scene.up, shown)}"


def _axis(signal: str, shown: Play) -> str:
    quantity, _, place = signal.removeprefix("-").removesuffix(")").partition("(")
    place = place.replace("*", shown.hypothesis.element)
    domain = domain_at(shown, place)
    own = "" if place in shown.without.by_name else "added "
    own = "" if ">" in place else own
    kind = Quantity(quantity)
    return f"{own}{domain.word(kind)} [{domain.unit(kind)}]"
