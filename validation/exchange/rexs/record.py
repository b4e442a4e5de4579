"""The parameters that REXS has no attributes for, carried in one attribute of spurcheck's own.

REXS lets programs add attributes named ``custom_...`` which others ignore. Spurcheck writes all parameters
of the pair there, as JSON, beside the standard attributes. Another program may have changed the standard ones
since, so on reading these decide, and the record gives the rest, the digits beyond the fifteenth, and the
first source of each value.
"""

from __future__ import annotations

import json
from typing import Any

from lumped.errors import ParameterError
from lumped.schema.files import load_gear_pair
from lumped.schema.pair import GearPair, leaf_paths
from validation.exchange.rexs.assumptions import ASSUMED
from validation.exchange.rexs.model import RexsModel, broken
from validation.exchange.rexs.relief import KINDS
from validation.exchange.rexs.said import Said
from validation.exchange.rexs.stages import Stage

ATTRIBUTE = "custom_spurcheck_parameters"


def record_text(pair: GearPair) -> str:
    """Return the record of a pair."""
    return json.dumps(pair.to_mapping(), ensure_ascii=True, allow_nan=False)


def recorded(model: RexsModel, stage: Stage) -> GearPair | None:
    """Return the pair that a stage's record describes, or None where it has no record.

    Raises
    ------
    ParameterError : a record that is no valid pair, or that names a file to read
    """
    attribute = model.components[stage.component_id].attributes.get(ATTRIBUTE)
    if attribute is None or attribute.value is None:
        return None
    try:
        data: Any = json.loads(str(attribute.value))
        if not isinstance(data, dict):
            raise ValueError("it is no mapping")
        mesh = data.get("mesh")
        stiffness = mesh.get("stiffness") if isinstance(mesh, dict) else None
        if isinstance(stiffness, dict) and "file" in stiffness:
            raise ValueError("it names a file to read, which a file from elsewhere must not")
        return load_gear_pair(data)
    except ParameterError as error:
        raise ParameterError(list(error.problems), f"{model.file}, {ATTRIBUTE}") from None
    except (ValueError, RecursionError) as error:
        reason = str(error)[:120] or "nested too deeply"
        raise broken(model.file, f"its attribute {ATTRIBUTE} is broken: {reason}") from None


def restored(said: Said, pair: GearPair, reference: GearPair, record: GearPair) -> GearPair:
    """Return the record's pair with every value that was changed in the file since.

    Parameters
    ----------
    said : what the file says; gets a note
    pair : read from the standard attributes of the file
    reference : read from the standard attributes of the record's own export
    record : the recorded pair
    """
    changed = _changes(said, pair, reference)
    result = record.with_(changed) if changed else record
    first = dict(record.sources)
    stage = next(c for c in said.model.components.values() if ATTRIBUTE in c.attributes)
    place = said.where(stage, ATTRIBUTE)
    sources = {}
    for path in leaf_paths(result):
        if path in ("name", "description"):
            continue
        origin = first.get(path) or _section_source(first, path)
        if any(path == p or path.startswith(f"{p}.") for p in changed):
            sources[path] = said.sources.get(path, ASSUMED)
        elif origin is not None and origin.startswith(ASSUMED):
            sources[path] = origin  # an assumption stays one, however often it is passed on
        else:
            where = said.sources.get(path, place)
            sources[path] = where if origin is None else f"{where}; there: {origin}"
    missing = len([path for path in leaf_paths(record) if path not in said.values])
    said.note(f"{missing} values that REXS has no attributes for come from {ATTRIBUTE}")
    if changed:
        said.note("changed in the file since spurcheck wrote it: " + ", ".join(changed))
    return load_gear_pair(result.to_mapping() | {"sources": sources})


def _changes(said: Said, pair: GearPair, reference: GearPair) -> dict[str, Any]:
    """Return field path -> value of what the file says otherwise than the record's export did."""
    now, then = leaf_paths(pair), leaf_paths(reference)
    known = [path for path in said.values if not path.startswith("shafts.")]
    changed: dict[str, Any] = {p: now[p] for p in known if p in now and now[p] != then.get(p)}
    if any(path.startswith("lubricant.") for path in changed):  # one oil replaces the other as a whole
        changed = {p: v for p, v in changed.items() if not p.startswith("lubricant.")}
        for key in ("viscosity_law", "viscosity"):
            if key in (oil := pair.to_mapping()["lubricant"]):
                changed[f"lubricant.{key}"] = oil[key]
    if pair.shafts is not None:  # an export has none outside its record
        changed["shafts"] = pair.to_mapping()["shafts"]
    for which in ("pinion", "gear"):
        for kind in KINDS:
            gone = getattr(getattr(reference, which), kind) is not None
            if gone and getattr(getattr(pair, which), kind) is None:
                changed[f"{which}.{kind}"] = None  # a relief taken off is a change of the design
    return changed


def _section_source(sources: dict[str, str], path: str) -> str | None:
    """Source of the nearest section that has one: a preset may say "bearings" for all of them."""
    while "." in path:
        path = path.rpartition(".")[0]
        if path in sources:
            return sources[path]
    return None
