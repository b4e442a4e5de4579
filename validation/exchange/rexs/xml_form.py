"""The XML form of REXS, read in one bounded pass that knows no entities, and written by its schema."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import NoReturn
from xml.parsers import expat

from validation.exchange.rexs.model import (
    Attribute,
    Component,
    LoadCase,
    Relation,
    RexsModel,
    assembled,
    broken,
)

#: The schema nests ten elements; more is no REXS.
_MAX_DEPTH = 32
_MAX_COMPONENTS = 200_000


def parse_xml(data: bytes, file: str) -> RexsModel:
    """Read the XML form.

    The parser is expat with handlers. A document type declaration, which every entity needs, is refused
    before anything in it is read, so nothing is fetched and nothing expands; arrays and matrices are skipped,
    so memory is bounded by the scalar attributes.

    Parameters
    ----------
    data : the document; encoding as it declares
    file : name for messages and sources

    Raises
    ------
    ParameterError : not well-formed, a document type declaration, or not a REXS model
    """
    reader = _Reader(file)
    try:
        reader.parser.Parse(data, True)
    except expat.ExpatError as error:
        raise broken(file, f"the XML is malformed: {error}") from None
    except (ValueError, LookupError) as error:  # an encoding that expat or Python does not know
        raise broken(file, str(error)) from None
    return assembled(file, reader.head, reader.components, reader.relations, reader.load_cases)


class _Reader:
    """Handlers of one document."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.head: dict[str, str] = {}
        self.components: list[Component] = []
        self.relations: list[Relation] = []
        self.load_cases: list[LoadCase] = []
        self._path: list[str] = []
        self._text: list[str] = []
        self._given: dict[str, str] = {}
        self._refs: list[tuple[str, int]] = []
        self._case: list[Component] = []
        self._count = 0
        self.parser = expat.ParserCreate(namespace_separator=" ")
        self.parser.buffer_text = True
        self.parser.StartDoctypeDeclHandler = self._doctype
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._characters

    def _doctype(self, *_: object) -> NoReturn:
        raise broken(self.file, "it has a document type declaration, which REXS does not use")

    def _start(self, tag: str, given: dict[str, str]) -> None:
        name = tag.rpartition(" ")[2]
        self._path.append(name)
        if len(self._path) > _MAX_DEPTH:
            raise broken(self.file, f"elements are nested deeper than {_MAX_DEPTH}")
        if len(self._path) == 1:
            if name != "model":
                raise broken(self.file, f"its root element is {name[:40]!r} instead of 'model'")
            self.head = given
        elif name == "relation":
            self._given, self._refs = given, []
        elif name == "ref":
            self._refs.append((given.get("role", ""), self._id(given)))
        elif name == "component":
            self._begin_component(given)
        elif name == "attribute":
            self._given, self._text = given, []
        elif name == "load_case":
            self._given, self._case = given, []
            self.load_cases.append(LoadCase(self._id(given), ()))

    def _begin_component(self, given: dict[str, str]) -> None:
        self._count += 1
        if self._count > _MAX_COMPONENTS:
            raise broken(self.file, f"it has more than {_MAX_COMPONENTS} components")
        component = Component(self._id(given), given.get("type", ""), given.get("name", ""), {})
        if "load_case" in self._path:
            self._case.append(component)
        elif "load_spectrum" not in self._path:  # what is left is the accumulation: results
            self.components.append(component)

    def _end(self, tag: str) -> None:
        name = self._path.pop()
        if name == "relation":
            order = self._given.get("order")
            number = int(order) if order is not None and order.isdecimal() else None
            self.relations.append(Relation(self._given.get("type", ""), tuple(self._refs), number))
        elif name == "attribute":
            self._end_attribute()
        elif name == "load_case":
            self.load_cases[-1] = LoadCase(self.load_cases[-1].id, tuple(self._case))

    def _end_attribute(self) -> None:
        in_case, in_spectrum = "load_case" in self._path, "load_spectrum" in self._path
        owners = self._case if in_case else self.components
        if "component" not in self._path or (in_spectrum and not in_case):
            return
        text = "".join(self._text).strip()
        attribute = Attribute(text or None, self._given.get("unit", ""))
        owners[-1].attributes[self._given.get("id", "")] = attribute

    def _characters(self, text: str) -> None:
        # Text of an array or a matrix has another element as its parent.
        if self._path[-1] == "attribute":
            self._text.append(text)

    def _id(self, given: dict[str, str]) -> int:
        text = given.get("id", "").strip()
        try:
            return int(text)
        except ValueError:
            reason = f"a component or relation has the id {text[:40]!r} instead of a number"
            raise broken(self.file, reason) from None


def to_xml(model: RexsModel, head: dict[str, str]) -> bytes:
    """Write the XML form: UTF-8 with a byte-order mark, as the specification asks.

    Parameters
    ----------
    model : to write
    head : attributes of the root element: version, applicationId, applicationVersion, date
    """
    root = ET.Element("model", head)
    relations = ET.SubElement(root, "relations")
    for number, relation in enumerate(model.relations, 1):
        given = {"id": str(number), "type": relation.type}
        if relation.order is not None:
            given["order"] = str(relation.order)
        node = ET.SubElement(relations, "relation", given)
        for role, component in relation.refs:
            hint = model.components[component].type
            ET.SubElement(node, "ref", {"id": str(component), "role": role, "hint": hint})
    parts = ET.SubElement(root, "components")
    for part in model.components.values():
        given = {"id": str(part.id), "type": part.type, "name": part.name}
        node = ET.SubElement(parts, "component", given)
        for key, attribute in part.attributes.items():
            entry = ET.SubElement(node, "attribute", {"id": key, "unit": attribute.unit})
            if isinstance(attribute.value, tuple):
                array = ET.SubElement(entry, "array")
                for value in attribute.value:
                    ET.SubElement(array, "c").text = _text(value)
            else:
                entry.text = _text(attribute.value)
    ET.indent(root)
    text: str = ET.tostring(root, encoding="unicode")
    return b"\xef\xbb\xbf" + f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:.15g}" if isinstance(value, float) else str(value)
