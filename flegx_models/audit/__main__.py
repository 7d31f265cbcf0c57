"""``python -m flegx_models.audit``: the audit as a table, as JSON, as a page."""

import argparse
import json
from pathlib import Path

from flegx_models.audit.whole import as_markdown, as_text, audit


def main(arguments: list[str] | None = None) -> None:
    """Print the audit, or write it where the options say."""
    parser = argparse.ArgumentParser(prog="python -m flegx_models.audit")
    parser.add_argument("--json", metavar="FILE", type=Path)
    parser.add_argument("--markdown", metavar="FILE", type=Path)
    options = parser.parse_args(arguments)
    found = audit()
    if options.json is not None:
        text = json.dumps(found.to_dict(), indent=2, ensure_ascii=False)
        options.json.write_text(text + "\n", encoding="utf-8")
    if options.markdown is not None:
        options.markdown.write_text(as_markdown(found), encoding="utf-8")
    if options.json is None and options.markdown is None:
        print(as_text(found))


if __name__ == "__main__":
    main()
