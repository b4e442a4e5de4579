"""Verdicts as JUnit XML, which continuous integration systems read."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any
from xml.etree import ElementTree

from validation.reporting.compare import Comparison
from validation.reporting.judged import Case, cases

#: Characters that XML 1.0 cannot hold.
_FORBIDDEN = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def junit(document: Mapping[str, Any], comparison: Comparison | None = None) -> str:
    """Return a JUnit document: one test suite per table or chapter, one test case per verdict.

    Parameters
    ----------
    document : data of report.json
    comparison : with an earlier report; every change past its tolerance is a failure
    """
    judged = list(cases(document))
    if comparison is not None:
        judged.append(
            Case(
                "comparison",
                f"{comparison.compared} values against the earlier report",
                "violated" if comparison.regressions else "ok",
                "changed" if comparison.regressions else "unchanged",
                "\n".join(map(str, comparison.regressions)),
            )
        )
        judged += [
            Case("comparison", change.path, "violated", change.kind, str(change))
            for change in comparison.regressions
        ]
    groups: dict[str, list[Case]] = {}
    for case in judged:
        groups.setdefault(case.group, []).append(case)
    root = ElementTree.Element(
        "testsuites", {"name": _clean(f"spurcheck {document['gear_pair']}")} | _counts(judged)
    )
    for group, members in groups.items():
        suite = ElementTree.SubElement(root, "testsuite", _counts(members) | {"name": _clean(group)})
        for case in members:
            element = ElementTree.SubElement(
                suite, "testcase", {"classname": _clean(f"spurcheck.{group}"), "name": _clean(case.name)}
            )
            if case.fails:
                failure = ElementTree.SubElement(element, "failure", {"message": _clean(case.text)})
                failure.text = _clean(case.detail)
            else:
                ElementTree.SubElement(element, "system-out").text = _clean(f"{case.text}\n{case.detail}")
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _counts(members: list[Case]) -> dict[str, str]:
    failed = sum(case.fails for case in members)
    return {"tests": str(len(members)), "failures": str(failed), "errors": "0"}


def _clean(text: str) -> str:
    return _FORBIDDEN.sub("\ufffd", text)
