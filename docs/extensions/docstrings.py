"""Docstrings as field lists.

The packages write ``name : meaning [unit]`` under Parameters, Attributes and Raises, with types in the
annotations, and plain text throughout. Here that becomes reStructuredText: names become fields, and
characters that would be markup are escaped.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from sphinx.application import Sphinx

_FIELDS = {"Parameters": "param", "Raises": "raises"}
_ITEM = re.compile(r"^(\*{0,2}\w[\w.]*(?:, \*{0,2}\w[\w.]*)*)(?: : (.*))?$")
_LITERAL = re.compile(r"``([^`]+)``|`([^`]+)`")


def escaped(text: str) -> str:
    """Plain text, with ``literals``, as reStructuredText."""
    result, end = [], 0
    for literal in _LITERAL.finditer(text):
        result += [_plain(text[end : literal.start()]), f"``{literal.group(1) or literal.group(2)}``"]
        end = literal.end()
    return "".join([*result, _plain(text[end:])])


def _plain(text: str) -> str:
    return re.sub(r"([*|`\\])|(?<=\w)(_)(?!\w)", r"\\\1\2", text)


def sections(lines: list[str]) -> Iterator[tuple[str, list[str]]]:
    """Split a docstring at its underlined headings; the first part has none."""
    title, body, i = "", [], 0
    while i < len(lines):
        if i + 1 < len(lines) and lines[i].strip() and re.fullmatch(r"-{3,}", lines[i + 1].strip()):
            yield title, body
            title, body, i = lines[i].strip(), [], i + 2
        else:
            body.append(lines[i])
            i += 1
    yield title, body


def items(body: list[str]) -> Iterator[tuple[str, str]]:
    """Names and meanings of a section."""
    name, text = "", []
    for line in body:
        start = None if line.startswith(" ") else _ITEM.match(line)
        if start:
            if name:
                yield name, " ".join(text)
            name, text = start.group(1), [start.group(2) or ""]
        else:
            text.append(line.strip())
    if name:
        yield name, " ".join(text)


def rewritten(lines: list[str]) -> list[str]:
    """The docstring as reStructuredText."""
    result: list[str] = []
    fields: list[str] = []
    for title, body in sections(lines):
        if title in _FIELDS:
            for names, text in items(body):
                for name in names.split(", "):
                    fields.append(f":{_FIELDS[title]} {escaped(name)}: {escaped(text).strip()}")
        elif title == "Attributes":
            result += ["", ".. rubric:: Attributes", ""]
            for names, text in items(body):
                shown = ", ".join(f"``{name}``" for name in names.split(", "))
                result.append(f"* {shown} – {escaped(text).strip()}")
            result.append("")
        elif title in ("Returns", "Yields"):
            fields.append(f":returns: {escaped(' '.join(line.strip() for line in body)).strip()}")
        else:
            if title:
                result += [f".. rubric:: {title}", ""]
            result += body if title == "Examples" else [escaped(line) for line in body]
    return [*result, "", *fields, ""]


def _process(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    if what == "data" and isinstance(obj, Mapping):  # whose docstring is that of dict
        lines[:] = ["Names: " + ", ".join(f"``{key}``" for key in obj) + ".", ""]
        return
    lines[:] = rewritten(lines)


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the hook."""
    app.connect("autodoc-process-docstring", _process)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
