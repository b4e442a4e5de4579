"""The JSON form of REXS: one object ``model`` with relations, components and perhaps a load spectrum."""

from __future__ import annotations

import json
from typing import Any

from validation.exchange.rexs.model import (
    Attribute,
    Component,
    LoadCase,
    Relation,
    RexsModel,
    assembled,
    broken,
)
from validation.exchange.rexs.vocabulary import ATTRIBUTES

#: Value identifiers whose value is one number, text or flag.
_SCALARS = (
    "floating_point",
    "integer",
    "boolean",
    "enum",
    "string",
    "reference_component",
    "file_reference",
    "date_time",
)


def parse_json(data: bytes, file: str) -> RexsModel:
    """Read the JSON form.

    Parameters
    ----------
    data : the document in UTF-8, with or without a byte-order mark
    file : name for messages and sources

    Raises
    ------
    ParameterError : malformed, not a REXS model, or a number that JSON does not have (NaN, Infinity)
    """

    def no_number(text: str) -> float:
        raise ValueError(f"{text} is no number of JSON")

    try:
        document = json.loads(data.decode("utf-8-sig"), parse_constant=no_number)
        model = document["model"]
        components = [_component(c) for c in model["components"]]
        relations = [_relation(r) for r in model["relations"]]
        spectra = model.get("load_spectrum") or []
        spectra = spectra if isinstance(spectra, list) else [spectra]
        cases = [case for spectrum in spectra for case in spectrum.get("load_cases") or ()]
        load_cases = [LoadCase(_id(c["id"]), tuple(map(_component, c["components"]))) for c in cases]
        head = {key: value for key, value in model.items() if isinstance(value, str)}
    except RecursionError:
        raise broken(file, "the JSON is nested too deeply") from None
    except KeyError as error:
        raise broken(file, f"the JSON has no {error} where REXS has one") from None
    except (ValueError, TypeError, AttributeError) as error:
        raise broken(file, f"the JSON is not of the form of REXS: {str(error)[:120]}") from None
    return assembled(file, head, components, relations, load_cases)


def _component(node: dict[str, Any]) -> Component:
    attributes = {_string(a["id"]): _attribute(a) for a in node.get("attributes") or ()}
    return Component(
        _id(node["id"]), _string(node.get("type", "")), _string(node.get("name") or ""), attributes
    )


def _attribute(node: dict[str, Any]) -> Attribute:
    value = next((node[key] for key in _SCALARS if key in node), None)
    if value is not None and not isinstance(value, (str, int, float, bool)):
        raise ValueError(f"attribute {node['id']!r} has a value that is no scalar")
    return Attribute(value, _string(node.get("unit") or ""))


def _relation(node: dict[str, Any]) -> Relation:
    refs = tuple((_string(r["role"]), _id(r["id"])) for r in node["refs"])
    order = node.get("order")
    return Relation(_string(node["type"]), refs, None if order is None else _id(order))


def _id(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise ValueError(f"an id is {str(value)[:40]!r} instead of a whole number")
    return value


def _string(value: object) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{str(value)[:40]!r} stands where text belongs")
    return value


def to_json(model: RexsModel, head: dict[str, str]) -> bytes:
    """Write the JSON form: UTF-8 with a byte-order mark, as the specification asks.

    Parameters
    ----------
    model : to write
    head : version, applicationId, applicationVersion, date
    """
    document: dict[str, Any] = dict(head)
    document["relations"] = [
        {"id": number, "type": r.type}
        | ({} if r.order is None else {"order": r.order})
        | {"refs": [{"id": i, "role": role, "hint": model.components[i].type} for role, i in r.refs]}
        for number, r in enumerate(model.relations, 1)
    ]
    document["components"] = [
        {
            "id": c.id,
            "type": c.type,
            "name": c.name,
            "attributes": [_written(c.type, key, a) for key, a in c.attributes.items()],
        }
        for c in model.components.values()
    ]
    text = json.dumps({"model": document}, indent=2, ensure_ascii=False, allow_nan=False)
    return b"\xef\xbb\xbf" + text.encode() + b"\n"


def _written(component: str, key: str, attribute: Attribute) -> dict[str, Any]:
    known = ATTRIBUTES[component].get(key)
    kind = "string" if known is None else known.kind
    value = list(attribute.value) if isinstance(attribute.value, tuple) else attribute.value
    return {"id": key, "unit": attribute.unit, kind: value}
