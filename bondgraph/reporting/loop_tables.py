"""A design in words and as plain data: what was required, reached and measured."""

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from bondgraph.loopshaping.measures import LoopMeasures
from bondgraph.loopshaping.shaping import Design
from bondgraph.loopshaping.zero_pole_gain import ZeroPoleGain

SCHEMA = 1


def design_text(design: Design) -> str:
    """Return a design as text: verdict, controller, requirements, measures."""
    required = [("requirement", "wanted", "reached", "")]
    required += [
        (
            v.name,
            v.wanted,
            f"{v.achieved:.5g} {v.unit}".strip(),
            "met" if v.met else f"missing {v.shortfall:.3g} {v.unit}".strip(),
        )
        for v in design.verdicts
    ]
    blocks = [
        design.statement,
        f"controller  {design.loop.controller}\n{_numbers(design)}",
        "\n".join(design.reasons),
        _aligned(required),
        _aligned([(name, value) for name, value in _figures(design.measures)]),
    ]
    return "\n\n".join(blocks)


def _numbers(design: Design) -> str:
    """Return the controller's kind and numbers, as they can be written down again."""
    controller = design.controller
    numbers = ", ".join(f"{p} {controller.value(p):.5g}" for p in controller.paths())
    return f"{controller.kind}: {numbers}"


def measures_text(measures: LoopMeasures) -> str:
    """Return the measures of a loop as an aligned table."""
    return _aligned([(name, value) for name, value in _figures(measures)])


def _figures(m: LoopMeasures) -> list[tuple[str, str]]:
    rows = [("stability", m.stability.value)]
    rows += [
        (
            "gain crossover",
            f"{g.omega:.5g} rad/s, phase margin {g.phase_margin:.4g}°, "
            f"delay margin {g.delay_margin:.4g} s",
        )
        for g in m.gain_crossovers
    ]
    rows += [
        ("phase crossover", f"{p.omega:.5g} rad/s, gain margin {p.gain_margin:.4g}")
        for p in m.phase_crossovers
        if 1e-3 < p.gain_margin < 1e3
    ]
    rows.append(("modulus margin", f"{m.modulus_margin:.4g}"))
    for name, peak in (
        ("peak sensitivity", m.sensitivity),
        ("peak complementary", m.complementary),
    ):
        rows.append((name, f"{peak.value:.4g} at {peak.omega:.4g} rad/s"))
    if m.bandwidth is not None:
        rows.append(("bandwidth", f"{m.bandwidth:.5g} rad/s"))
    if m.step is not None:
        rows += [
            ("rise time", f"{m.step.rise_time:.4g} s"),
            ("settling time", f"{m.step.settling_time:.4g} s"),
            ("overshoot", f"{m.step.overshoot:.3g} %"),
            ("steady-state error", f"{m.step.steady_state_error:.3g}"),
        ]
    return rows


def _aligned(rows: Sequence[tuple[str, ...]]) -> str:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return "\n".join(
        "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip()
        for row in rows
    )


def design_to_dict(design: Design) -> dict[str, Any]:
    """Return a design as plain data for JSON; what is infinite becomes None."""
    controller = design.controller
    return {
        "schema": SCHEMA,
        "status": design.status.name.lower(),
        "statement": design.statement,
        "controller": {
            "kind": controller.kind,
            "numbers": {p: _plain(controller.value(p)) for p in controller.paths()},
            **_system(design.loop.controller),
        },
        "plant": _system(design.loop.plant),
        "feedback": _system(design.loop.feedback),
        "requirements": [_plain(asdict(v)) for v in design.verdicts],
        "binding": list(design.binding),
        "reasons": list(design.reasons),
        "measures": measures_to_dict(design.measures),
    }


def measures_to_dict(measures: LoopMeasures) -> dict[str, Any]:
    """Return the measures of a loop as plain data for JSON."""
    plain: dict[str, Any] = _plain(asdict(measures))
    plain["stability"] = measures.stability.name.lower()
    plain["crossover"] = measures.crossover
    plain["modulus_margin"] = _plain(measures.modulus_margin)
    return plain


def _system(system: ZeroPoleGain) -> dict[str, Any]:
    plain: dict[str, Any] = _plain(asdict(system))
    return plain


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value
