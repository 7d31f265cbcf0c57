"""What the page says of a finding: its rivals once, what was found, a curve folded."""

import re
from dataclasses import replace

from handmade_diagnosis import cart_diagnosis, estimate, evidence

from bondgraph.diagnosis.records import Diagnosis, Evidence, Support
from bondgraph.reporting.page.evidence import best_of_each
from bondgraph.reporting.report import report_html

POINTS = 8
MARK = '<span class="tag found">found</span>'


def rows(html: str, *, having: str = "") -> list[str]:
    """Return the words of the rows of all tables that have something in them."""
    return [
        " ".join(re.sub(r"<[^>]+>", " ", row).split())
        for row in re.findall(r"<tr>(.*?)</tr>", html, re.S)
        if having in row
    ]


def facts(html: str, term: str) -> str:
    (found,) = re.findall(rf"<dt>{term}</dt>\s*<dd>(.*?)</dd>", html, re.S)
    return found


def hysteresis(support: Support) -> Evidence:
    return evidence("hysteresis", "carriage", "z", support, (0.5, 0.1, 0.1, 0.1))


def without_a_name() -> Diagnosis:
    """Return an answer whose finding is a curve of eight points."""
    found = cart_diagnosis()
    points = tuple(
        estimate(f"curve_{k}", 2.0 * k - 7.0, 0.3, "N", 1.0) for k in range(POINTS)
    )
    (finding,) = found.findings
    after = found.fit_after
    return replace(
        found,
        findings=(replace(finding, physics="unknown_relation", estimates=points),),
        fit_after=replace(after, estimates=(*after.estimates[:2], *points)),
    )


def test_of_a_law_tried_in_several_ways_the_best_that_stands_is_considered():
    one_number_more = hysteresis(Support.REFUTED)
    plain = replace(hysteresis(Support.SUPPORTED), gain=0.45)
    worse = replace(plain, gain=0.2)
    assert best_of_each([one_number_more, plain, worse]) == [plain]
    other = replace(one_number_more, physics="spring", gain=0.47)
    assert best_of_each([one_number_more, other, plain]) == [other, plain]
    assert best_of_each([one_number_more]) == [one_number_more]


def test_a_rival_that_was_tried_in_several_ways_is_named_once_as_its_best_way():
    found = cart_diagnosis()
    (finding,) = found.findings
    ways = (Support.REFUTED, Support.UNDECIDED, Support.SUPPORTED)
    finding = replace(finding, alternatives=tuple(map(hysteresis, ways)))
    html = report_html(replace(found, findings=(finding,)))
    assert facts(html, "Could also be") == "hysteresis at carriage"
    assert "Hardly supported" not in html
    finding = replace(finding, alternatives=(hysteresis(Support.REFUTED),) * 2)
    html = report_html(replace(found, findings=(finding,)))
    assert facts(html, "Could also be") == "nothing else that was considered"
    assert facts(html, "Hardly supported") == "hysteresis at carriage"


def test_the_candidate_that_was_found_is_marked_once():
    found = cart_diagnosis()
    again = replace(found, candidates=(*found.candidates, found.candidates[0]))
    (marked,) = rows(report_html(again), having=MARK)
    assert marked.startswith("Coulomb (dry) friction at carriage F_c*sign(f) supported")
    assert rows(report_html(replace(found, findings=())), having=MARK) == []


def test_the_points_of_a_curve_without_a_name_are_folded():
    html = report_html(without_a_name())
    assert f"<summary>{POINTS} numbers of the curve</summary>" in html
    opened, folded = html.split(f"<summary>{POINTS} more: the numbers of the curve")
    parameters = opened[opened.rindex('id="parameters"') :]
    assert "viscous" in parameters
    assert "curve_0" not in parameters
    assert sum(row.startswith("curve_") for row in rows(folded)) == POINTS


def test_a_law_with_a_name_shows_its_numbers_at_once():
    html = report_html(cart_diagnosis())
    assert "20.41 ± 0.12 N" in facts(html, "F_c")
    assert "numbers of the curve" not in html


def test_the_picture_of_a_law_says_what_its_points_do_not_count_in():
    found = cart_diagnosis()
    (first,) = found.findings
    later = replace(first, physics="sensor_bias", place="velocity")
    html = report_html(replace(found, findings=(first, later)))
    assert "found afterwards (sensor bias at velocity), so the points may" in html
    html = report_html(replace(found, findings=(later, first)))
    assert "found afterwards" not in html
