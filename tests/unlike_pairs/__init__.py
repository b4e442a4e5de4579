"""Six gear pairs that are unlike each other and unlike the presets: what tests of physics run on.

Each file is named after what is unlike in it. No two numbers of a kind are equal in a file, and no value of
one pair is that of another where it could be avoided: teeth, rack, shifts, widths, material, bearings,
stiffness model, friction law, oil, contact. A fault that equal gears or a 20-degree rack hide shows on them.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

from lumped import GearPair, load_gear_pair
from lumped.fields.units import to_file
from lumped.schema.assumed import WORDS
from lumped.schema.pair import leaf_paths

#: Names of the pairs, which are the names of their files.
UNLIKE = tuple(sorted(path.stem for path in Path(__file__).parent.glob("*.toml")))


@cache
def unlike_pair(name: str) -> GearPair:
    """Return the pair of this name; equal arguments give the same object, so that it is read once.

    All of its values are assumed: nobody made such gears.
    """
    return all_assumed(load_gear_pair(Path(__file__).with_name(f"{name}.toml")))


def but_known(pair: GearPair, *fields: str) -> GearPair:
    """Return a pair of which these fields, or all inside them, are known."""
    assumed = {
        path: value
        for path, value in pair.assumed.to_mapping().items()
        if not any(f"{path}.".startswith(f"{one}.") for one in fields)
    }
    return pair.with_(assumed=assumed)


def all_assumed(pair: GearPair) -> GearPair:
    """Return a pair of which nothing is known."""
    return pair.with_(assumed={path: v for path, v in leaf_paths(pair).items() if path not in WORDS})


def known_sizes(pair: GearPair) -> GearPair:
    """Return the pair with the profile shifts and tips that it has, which are known then."""
    alteration = to_file(pair.tip_alteration, "mm")
    shifts = zip(("pinion", "gear"), pair.profile_shifts, strict=True)
    sizes = {f"{gear}.profile_shift": shift for gear, shift in shifts}
    return pair.with_(sizes | {f"{gear}.tip_alteration": alteration for gear in ("pinion", "gear")})
