"""Where the values of a gear pair come from: a source, or an assumption."""

from __future__ import annotations

from functools import cache

from lumped import GearPair, load_gear_pair
from lumped.schema.files import preset_names
from lumped.schema.pair import field_at, leaf_paths

#: Source of a value that the parameter file leaves to the schema.
DEFAULT = "default of the schema"
#: Source of a value that the file gives without one.
GIVEN = "given without a source"


def sources(pair: GearPair) -> dict[str, str]:
    """Path of every value of a gear pair -> its source."""
    return {path: source_of(pair, path) for path in leaf_paths(pair) if path not in ("name", "description")}


def source_of(pair: GearPair, path: str) -> str:
    """Where the value of a field comes from: the source of the longest prefix of its path that has one.

    A file that began as a preset may still give the preset's source for a value changed since: that value is
    assumed, for all the file says.
    """
    source = _stated(pair, path)
    if is_assumed(source):
        return source
    presets = [preset for preset in _presets() if _stated(preset, path) == source]
    value = leaf_paths(pair).get(path)
    if not presets or any(leaf_paths(p).get(path) == value for p in presets):
        return source
    return f"assumed; the source in the file is that of {presets[0].name} for another value"


def is_assumed(source: str) -> bool:
    """Whether a source says that nobody measured or published the value for this pair."""
    return "assumed" in source.lower() or source in (DEFAULT, GIVEN)


def _stated(pair: GearPair, path: str) -> str:
    sources = dict(pair.sources)
    parts = path.split(".")
    prefixes = (".".join(parts[:length]) for length in range(len(parts), 0, -1))
    stated = next((sources[prefix] for prefix in prefixes if prefix in sources), None)
    if stated is None:
        return DEFAULT if leaf_paths(pair).get(path) == field_at(path).default else GIVEN
    return stated


@cache
def _presets() -> tuple[GearPair, ...]:
    return tuple(map(load_gear_pair, preset_names()))
