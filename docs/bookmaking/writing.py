"""All written pages at once, each touched only where it changed."""

from collections.abc import Mapping
from pathlib import Path

from bookmaking import cookbook, gallery, navigation, reference


def write_all(docs: Path) -> None:
    """Write every page and picture below `docs`; remove those of entries now gone."""
    for folder, files in (
        ("reference/generated", reference.pages()),
        ("cookbook/generated", cookbook.pages()),
        ("gallery/generated", gallery.pages()),
        ("tutorials/generated", navigation.tutorials()),
        ("concepts/generated", navigation.rest()),
    ):
        _write(docs / folder, files)


def _write(folder: Path, files: Mapping[str, str]) -> None:
    """Make `folder` hold exactly `files`, leaving alone what is so already."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in folder.iterdir():
        if path.name not in files:
            path.unlink()
    for name, text in files.items():
        path = folder / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
