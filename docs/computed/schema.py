"""Reference of the parameter file, the friction laws and the presets, from the code that checks them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import lumped
from computed.markdown import Cell, table, text
from lumped.fields.scope import LIMITS
from lumped.friction import LAWS

_LIMITS = (
    ("exclusiveMinimum", "> {:g}"),
    ("minimum", "≥ {:g}"),
    ("exclusiveMaximum", "< {:g}"),
    ("maximum", "≤ {:g}"),
)


def _branches(field: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    yield field
    for key in ("anyOf", "oneOf"):
        for branch in field.get(key, ()):
            yield from _branches(branch)
    if "items" in field:
        yield from _branches(field["items"])


def _allowed(field: Mapping[str, Any]) -> str:
    """Range or choices of a field, in words."""
    found: list[str] = []
    for branch in _branches(field):
        found += [sign.format(branch[key]) for key, sign in _LIMITS if key in branch]
        found += [f"`{value}`" for value in branch.get("enum", ())]
        found += [f"`{branch['const']}`"] if "const" in branch else []
        found += (
            [f"[{branch['$ref'].split('/')[-1]}](#{_anchor(branch['$ref'])})"] if "$ref" in branch else []
        )
        found += ["true or false"] if branch.get("type") == "boolean" else []
    return ", ".join(dict.fromkeys(found))


def _anchor(reference: str) -> str:
    return "section-" + reference.split("/")[-1].lower()


def _default(field: Mapping[str, Any], required: bool) -> Cell:
    if required:
        return "required"
    default = field.get("default")
    if default is None or default == "":
        return None
    return f"`{default}`" if isinstance(default, str | float | int) else text(str(default))


def _section(name: str, section: Mapping[str, Any], anchor: str) -> str:
    rows: list[tuple[Cell, ...]] = []
    for key, field in section["properties"].items():
        unit = str(field.get("unit", "")).replace("**", "^").replace("*", " ")
        rows.append(
            (
                f"`{key}`",
                field.get("description", ""),
                "–" if unit in ("", "1") else unit,
                _allowed(field),
                _default(field, key in section.get("required", ())),
            )
        )
    heading = f"({anchor})=\n## {name}\n\n{text(section.get('description', ''))}\n\n"
    return heading + table(("field", "meaning", "unit of a bare number", "allowed", "default"), rows)


def parameters() -> str:
    """Every field of a parameter file."""
    schema = lumped.json_schema()
    parts = [_section("The file", schema, "section-file")]
    parts += [_section(name, s, _anchor(name)) for name, s in schema["$defs"].items()]
    return "\n".join(parts)


def laws() -> str:
    """Friction laws with the validity ranges of their arguments."""
    rows: list[tuple[Cell, ...]] = []
    for name, law in LAWS.items():
        stated = [f"{r} ({r.source})" for r in law.ranges if r.stated]
        silent = [r.quantity for r in law.ranges if not r.stated]
        rows.append(
            (f"`{name}`", law.title, "; ".join(stated) or "–", ", ".join(dict.fromkeys(silent)) or "–")
        )
    return table(("law", "title", "stated range", "no range stated by the sources"), rows)


def presets() -> str:
    """Built-in gear pairs."""
    rows: list[tuple[Cell, ...]] = []
    for name in lumped.preset_names():
        pair = lumped.load_gear_pair(name)
        ratio = lumped.geometry(pair).contact_ratio
        rows.append((f"`{name}`", pair.description, f"{pair.pinion.teeth}/{pair.gear.teeth}", float(ratio)))
    return table(("preset", "what it is", "teeth", "contact ratio"), rows)


def scope() -> str:
    """What a drawing may have and no parameter file, with the sentence that a refusal has."""
    rows = [
        (one.subject, ", ".join(f"`{key}`" for key in one.names + one.stems), one.sentence) for one in LIMITS
    ]
    return table(("not computed", "keys that mean it", "what spurcheck does instead"), rows)


FILES = {"parameters.md": parameters, "laws.md": laws, "presets.md": presets, "scope.md": scope}
