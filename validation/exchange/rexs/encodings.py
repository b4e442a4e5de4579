"""Encodings of REXS. XML and JSON are read and written, both as the same tree. ZIP archives are read."""

from __future__ import annotations

import io
import json
import struct
import xml.etree.ElementTree as ET
import zipfile
import zlib
from pathlib import Path, PurePosixPath
from typing import Any

from lumped.arguments import file_path
from lumped.errors import ParameterError, shown
from lumped.fields.text_file import read_bytes
from validation.exchange.rexs.model import Document, RexsModel, broken, model_of

#: Largest file, and largest model in an archive [bytes]. Models of complete gear units with tables of results
#: have a few megabytes.
MAX_BYTES = 32_000_000
#: Largest depth of XML elements. The schema of REXS has ten levels.
_MAX_DEPTH = 32
_MAX_ELEMENTS = 1_000_000
_BLOCK = 65536
_SKIPPED = ET.Element("skipped")
_MARK = b"\xef\xbb\xbf"
#: Errors of zipfile for a damaged archive. A seek may fail, because zipfile trusts the stored offsets.
_DAMAGED = (zipfile.BadZipFile, zlib.error, struct.error, OSError, EOFError, ValueError, RuntimeError)
#: Suffix of a file to write -> its form.
FORMS = {".rexs": "xml", ".rexsj": "json"}


def read_rexs(path: str | Path) -> RexsModel:
    """Read a REXS file. The content decides the encoding, not the name. A broken file is refused."""
    path = file_path("path", path)
    data = read_bytes(path, MAX_BYTES, field="REXS file")
    if data[:2] == b"PK":
        data = _unzipped(data, path.name)
    start = data.removeprefix(_MARK).lstrip()[:1]
    if start == b"{":
        document = from_json(data, path.name)
    elif start == b"<" or data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        document = from_xml(data, path.name)
    else:
        raise broken(path.name, "it is neither XML nor JSON nor a ZIP archive")
    return model_of(document, path.name)


def _unzipped(data: bytes, file: str) -> bytes:
    """Return the one model of an archive. Nothing is written to disk."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = [m for m in archive.infolist() if not PurePosixPath(m.filename).name.startswith("._")]
            for suffixes in (tuple(FORMS), (".xml", ".json")):
                if models := [m for m in members if m.filename.lower().endswith(suffixes)]:
                    break
            if len(models) != 1:
                raise broken(file, f"the archive has {len(models)} models instead of one")
            if models[0].compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise broken(file, f"the member {shown(models[0].filename)!r} is not compressed by 'deflate'")
            with archive.open(models[0]) as stream:
                content = stream.read(MAX_BYTES + 1)  # the size that the archive states may be a lie
    except ParameterError:
        raise
    except _DAMAGED as error:
        raise broken(file, f"the archive cannot be read: {error}") from None
    if len(content) > MAX_BYTES:
        raise broken(file, f"the model in the archive has more than {MAX_BYTES} bytes")
    return content


def from_json(data: bytes, file: str) -> Document:
    def no_number(text: str) -> float:
        raise ValueError(f"{text} is no number of JSON")

    try:
        document: Document = json.loads(data.decode("utf-8-sig"), parse_constant=no_number)
    except RecursionError:
        raise broken(file, "the JSON is nested too deeply") from None
    except ValueError as error:
        raise broken(file, f"the JSON is not of the form of REXS: {str(error)[:120]}") from None
    return document


def from_xml(data: bytes, file: str) -> Document:
    """Read XML in one bounded pass that knows no entities.

    Every entity needs a document type declaration. Such a declaration is refused before its content is read,
    so that nothing is fetched or expanded. Arrays and matrices are skipped, so that scalar attributes alone
    need memory.
    """
    parser = ET.XMLParser(target=_Elements(file))
    try:
        for start in range(0, len(data), _BLOCK):  # expat would copy a single large block
            parser.feed(data[start : start + _BLOCK])
        root: ET.Element = parser.close()
    except ParameterError:
        raise
    except (ET.ParseError, ValueError, LookupError) as error:  # LookupError: an unknown encoding
        raise broken(file, f"the XML is malformed: {error}") from None
    if root.tag != "model":
        raise broken(file, f"its root element is {root.tag[:40]!r} instead of 'model'")

    def components(parent: ET.Element, path: str) -> list[dict[str, Any]]:
        return [
            {"id": "", **part.attrib, "attributes": [attribute(a) for a in part.iter("attribute")]}
            for part in parent.iterfind(path)
        ]

    def attribute(a: ET.Element) -> dict[str, Any]:
        return {"id": a.get("id", ""), "unit": a.get("unit"), "string": (a.text or "").strip() or None}

    return {
        "model": {
            **root.attrib,
            "components": components(root, "components/component"),
            "relations": [
                {**r.attrib, "refs": [{"id": "", **ref.attrib} for ref in r.iter("ref")]}
                for r in root.iterfind("relations/relation")
            ],
            "load_spectrum": {
                "load_cases": [
                    {"id": case.get("id", ""), "components": components(case, ".//component")}
                    for case in root.iter("load_case")
                ]
            },
        }
    }


class _Elements(ET.TreeBuilder):
    """Target of the parser: builds a tree without namespaces and without elements inside attributes."""

    def __init__(self, file: str) -> None:
        super().__init__()
        self.file = file
        self.count = 0
        self.path: list[str] = []

    def doctype(self, *_: object) -> None:
        raise broken(self.file, "it has a document type declaration, which REXS does not use")

    def start(self, tag: str, attributes: dict[Any, Any]) -> ET.Element:
        inside = "attribute" in self.path
        _, _, name = tag.rpartition("}")
        self.path.append(name)
        self.count += not inside
        if len(self.path) > _MAX_DEPTH:
            raise broken(self.file, f"elements are nested deeper than {_MAX_DEPTH}")
        if self.count > _MAX_ELEMENTS:
            raise broken(self.file, f"it has more than {_MAX_ELEMENTS} elements")
        return _SKIPPED if inside else super().start(name, attributes)

    def end(self, _: str) -> ET.Element:
        name = self.path.pop()
        return _SKIPPED if "attribute" in self.path else super().end(name)

    def data(self, text: str) -> None:
        if self.path[-1] == "attribute":
            super().data(text)


def encoded(document: Document, form: str) -> bytes:
    """Return the bytes of a tree in "xml" or "json": UTF-8 with a byte-order mark, as REXS specifies."""
    if form == "json":
        return _MARK + json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False).encode() + b"\n"
    return _MARK + b'<?xml version="1.0" encoding="UTF-8"?>\n' + _xml(document["model"]).encode() + b"\n"


def _xml(model: dict[str, Any]) -> str:
    def add(parent: ET.Element, tag: str, node: dict[str, Any]) -> ET.Element:
        return ET.SubElement(parent, tag, {k: _text(v) for k, v in node.items() if not isinstance(v, list)})

    root = ET.Element("model", {key: value for key, value in model.items() if isinstance(value, str)})
    relations = ET.SubElement(root, "relations")
    parts = ET.SubElement(root, "components")
    for relation in model["relations"]:
        element = add(relations, "relation", relation)
        for ref in relation["refs"]:
            add(element, "ref", ref)
    for component in model["components"]:
        element = add(parts, "component", component)
        for attribute in component["attributes"]:
            *named, (_, value) = attribute.items()
            entry = add(element, "attribute", dict(named))
            if isinstance(value, list):
                array = ET.SubElement(entry, "array")
                for cell in value:
                    ET.SubElement(array, "c").text = _text(cell)
            else:
                entry.text = _text(value)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode")


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:.15g}" if isinstance(value, float) else str(value)
