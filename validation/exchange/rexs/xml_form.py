"""The XML form of REXS, read in one bounded pass that knows no entities, and written by its schema."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from lumped.errors import ParameterError
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
_MAX_ELEMENTS = 1_000_000
_BLOCK = 65536


def parse_xml(data: bytes, file: str) -> RexsModel:
    """Read the XML form.

    A document type declaration, which every entity needs, is refused before anything in it is read, so
    nothing is fetched and nothing expands; arrays and matrices are skipped, so memory is bounded by the
    scalar attributes.

    Parameters
    ----------
    data : the document; encoding as it declares
    file : name for messages and sources

    Raises
    ------
    ParameterError : not well-formed, a document type declaration, or not a REXS model
    """
    parser = ET.XMLParser(target=_Tree(file))
    try:
        for start in range(0, len(data), _BLOCK):  # in one piece expat would keep a copy of it
            parser.feed(data[start : start + _BLOCK])
        root: ET.Element = parser.close()
    except ParameterError:
        raise
    except ET.ParseError as error:
        raise broken(file, f"the XML is malformed: {error}") from None
    except (ValueError, LookupError) as error:  # an encoding that expat or Python does not know
        raise broken(file, str(error)) from None
    if root.tag != "model":
        raise broken(file, f"its root element is {root.tag[:40]!r} instead of 'model'")

    def number(node: ET.Element) -> int:
        text = node.get("id", "").strip()
        try:
            return int(text)
        except ValueError:
            reason = f"a component or relation has the id {text[:40]!r} instead of a number"
            raise broken(file, reason) from None

    def component(node: ET.Element) -> Component:
        attributes = {
            a.get("id", ""): Attribute((a.text or "").strip() or None, a.get("unit", ""))
            for a in node.iter("attribute")
        }
        return Component(number(node), node.get("type", ""), node.get("name", ""), attributes)

    def relation(node: ET.Element) -> Relation:
        refs = tuple((ref.get("role", ""), number(ref)) for ref in node.iter("ref"))
        order = node.get("order", "")
        return Relation(node.get("type", ""), refs, int(order) if order.isdecimal() else None)

    return assembled(
        file,
        dict(root.attrib),
        [component(node) for node in root.iterfind("components/component")],
        [relation(node) for node in root.iterfind("relations/relation")],
        [LoadCase(number(c), tuple(map(component, c.iter("component")))) for c in root.iter("load_case")],
    )


class _Tree:
    """Target of the parser: a tree without namespaces and without what stands inside attributes."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.builder = ET.TreeBuilder()
        self.path: list[str] = []
        self.count = 0

    def doctype(self, *_: object) -> None:
        raise broken(self.file, "it has a document type declaration, which REXS does not use")

    def start(self, tag: str, given: dict[str, str]) -> None:
        inside = "attribute" in self.path
        self.path.append(tag.rpartition("}")[2])
        if len(self.path) > _MAX_DEPTH:
            raise broken(self.file, f"elements are nested deeper than {_MAX_DEPTH}")
        if not inside:
            self.count += 1
            if self.count > _MAX_ELEMENTS:
                raise broken(self.file, f"it has more than {_MAX_ELEMENTS} elements")
            self.builder.start(self.path[-1], given)

    def end(self, _: str) -> None:
        name = self.path.pop()
        if "attribute" not in self.path:
            self.builder.end(name)

    def data(self, text: str) -> None:
        if self.path[-1] == "attribute":
            self.builder.data(text)

    def close(self) -> ET.Element:
        return self.builder.close()


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
