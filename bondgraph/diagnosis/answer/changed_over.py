"""A finding's mirror images: places that its model may change over with its own.

No recording tells them apart, and the search, which began from the author's values,
ended at one of them by chance. The values it ended with may be nearer to those of the
other.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

from bondgraph.diagnosis.answer.wording import listed
from bondgraph.diagnosis.records import Finding
from bondgraph.fitting.result import Estimate
from bondgraph.structure.graph import FinishedGraph
from bondgraph.structure.mirror import Image, mirror_images

NEARER = 0.5
"""Squared distances of values below this share of others speak for a place."""


def with_images(
    findings: Sequence[Finding], graph: FinishedGraph, estimates: Sequence[Estimate]
) -> list[Finding]:
    """Return the findings, each with the places that nothing tells from its own.

    Parameters
    ----------
    graph
        The model before anything was added.
    estimates
        Of the model with all findings.
    """
    if not findings:
        return []
    images = mirror_images(graph)
    return [_with_images(finding, images, graph, estimates) for finding in findings]


def _with_images(
    finding: Finding,
    images: Sequence[Image],
    graph: FinishedGraph,
    estimates: Sequence[Estimate],
) -> Finding:
    own = finding.place
    places = dict.fromkeys(image.of(own) for image in images)
    others = [place for place in places if place != own]
    if not others:
        return finding
    far = {
        place: min(
            _distance(image, graph, estimates)
            for image in images
            if image.of(own) == place
        )
        for place in places
    }
    nearest = min(far, key=lambda place: far[place])
    rather = (
        f" The values that it begins with are nearer with it at {nearest}."
        if nearest != own and far[nearest] < NEARER * far[own]
        else ""
    )
    return replace(
        finding,
        statement=f"{finding.statement} The model is the same with {own} and "
        f"{listed(others)} changed over, so that no recording tells which of them it "
        f"is; a stated value there, or a sensor, would.{rather}",
        indistinguishable_places=tuple(
            dict.fromkeys((*finding.indistinguishable_places, *others))
        ),
    )


def _distance(
    image: Image, graph: FinishedGraph, estimates: Sequence[Estimate]
) -> float:
    """Return by which squared logarithms estimates differ from what they begin at."""
    total = 0.0
    for estimate in estimates:
        there = graph.parameters.get(image.parameter.get(estimate.name, ""))
        if there and there.value and there.value * estimate.value > 0.0:
            total += math.log(estimate.value / there.value) ** 2
    return total
