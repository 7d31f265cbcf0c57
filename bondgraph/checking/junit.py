"""A check report as JUnit XML, which CI services show test by test."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

from bondgraph.checking.run import CheckReport, CheckResult

# What XML 1.0 cannot carry even when escaped, and TOML texts can.
_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write_junit(report: CheckReport, path: Path) -> None:
    """Write `report` to `path` as JUnit XML: one test case per check.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    failures = str(len(report.failed))
    counts = {"tests": str(len(report.results)), "failures": failures, "errors": "0"}
    root = ET.Element("testsuites", counts)
    suite = ET.SubElement(root, "testsuite", {"name": _text(report.source), **counts})
    for result in report.results:
        suite.append(_case(result))
    ET.indent(root)
    ET.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def _case(result: CheckResult) -> ET.Element:
    check = result.check
    case = ET.Element(
        "testcase", {"classname": _text(check.model), "name": _text(check.name)}
    )
    if not result.ok:
        failure = {"message": _text(result.statement), "type": "check"}
        ET.SubElement(case, "failure", failure).text = _text(result.statement)
    return case


def _text(text: str) -> str:
    return _NOT_XML.sub("\ufffd", text)
