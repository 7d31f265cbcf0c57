"""What became of the mutants, package by package, and which survived."""

from collections import Counter
from pathlib import Path

from benchmarks.mutation.covering import TRUSTED
from benchmarks.mutation.running import entries

KILLED = ("killed", "out of time")


def told(work: Path) -> str:
    """Return the shares of killed mutants and the names of the survivors."""
    found = entries(work)
    lines = [f"{len(found)} mutants tried of {found[0]['of'] if found else 0}"]
    for package in TRUSTED:
        fates = Counter(e["fate"] for e in found if e["name"].startswith(package))
        total = fates.total()
        killed = sum(fates[fate] for fate in KILLED)
        share = f"{100 * killed / total:.0f} %" if total else "none"
        told_fates = ", ".join(f"{n} {fate}" for fate, n in fates.most_common())
        lines.append(f"{package}: {killed} of {total} killed ({share}): {told_fates}")
    lines += [f"  {e['fate']}: {e['name']}" for e in found if e["fate"] not in KILLED]
    return "\n".join(lines)
