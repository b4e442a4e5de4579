"""Explanations that alter where tooth pairs touch, and of what their stiffness is made.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence

from lumped.schema.pair import GearPair
from lumped.stiffness.energy import EnergyStiffness
from lumped.stiffness.parabolic import ParabolicStiffness, iso_end_ratio
from validation.check.explanations.cause import Cause, Choice, Kind, Variant
from validation.check.explanations.contact_laws import COMPLIANCES, Compliance, TableJoin
from validation.check.explanations.fields import reference_radii, tip_radii, with_prescribed_contact
from validation.check.problem import Problem

#: Trial lengths over the base pitch by which an end of the path of contact moves.
_ENDS = (-0.6, -0.3, -0.1, 0.1, 0.3, 0.6)
#: Trial places of the peak of a parabola over half the path.
_PEAKS = (-0.5, -0.2, 0.2, 0.5)
#: Entries of a table of the mesh stiffness over the mesh cycle, by how they are joined.
_TABLES: Mapping[TableJoin, tuple[int, ...]] = {
    "lines": (4, 5, 6, 8, 9, 10, 12, 15, 16, 20),
    "steps": (8, 10, 12, 16, 20, 24, 30, 36),
    "middles": (8, 10, 12, 16, 20, 24, 30, 36),
    "spline": (8, 10, 12, 16, 20, 24),
}
#: The same of tables that have the friction coefficient too: joins, entries.
_OF_FRICTION_TOO: tuple[TableJoin, ...] = ("steps", "middles")
_TABLES_WITH_FRICTION = (8, 10, 12, 16, 20)
_JOINED: Mapping[TableJoin, str] = {
    "lines": "joined by straight lines",
    "steps": "without interpolation",
    "middles": "without interpolation, each for half a step before and behind it",
    "spline": "joined by a cubic spline",
}
#: Entries of a table of the stiffness of a tooth pair in a base pitch; negative: none at A.
_PAIR_TABLES = (-5, -6, -8, -10, -12, -16, -20, 5, 8, 10, 16, 20)
#: Trial compliances in series with a tooth pair, over that of the mean stiffness of a pair.
_SERIES = (-0.4, -0.2, 0.2, 0.5, 1.0)
#: A path of contact is another one from this share of the base pitch on.
_APART = 5e-3


def may_vary(problem: Problem, variant: Variant) -> bool:
    """Return whether the stiffness over the mesh cycle can be altered."""
    return not variant.physics.of_stiffness and not variant.pair.mesh.stiffness.whole_mesh


def _changed(label: float | str, words: str, change: Callable[[Variant], Variant]) -> Choice:
    """A fixed value with prescribed contact."""
    return Choice(label, words, lambda variant: change(with_prescribed_contact(variant)))


def _path(start: float, end: float) -> Callable[[Variant], Variant]:
    """Change of a variant by base pitches by which the path of contact starts and ends later."""
    return lambda variant: with_ends_of(variant, end - start).with_physics(path_start=start, path_end=end)


def with_ends_of(variant: Variant, longer: float) -> Variant:
    """Return a variant whose parabola has the ends of a path that is longer by so many base pitches.

    Only where the contact ratio decides the ends, as in ISO 6336-1.
    """
    stiffness = variant.pair.mesh.stiffness
    if not isinstance(stiffness, ParabolicStiffness) or stiffness.end_ratio is not None:
        return variant
    ratio = max(variant.pair.geometry.contact_ratio + longer, 1.0)
    return variant.with_inputs({"mesh.stiffness.end_ratio": iso_end_ratio(ratio)})


def _contact_ratio(problem: Problem, variant: Variant) -> list[Choice]:
    """Other contact ratios: zones of contact exchanged or equal, the circular pitch for the base pitch."""
    if not may_vary(problem, variant):
        return []
    ratio = variant.pair.geometry.contact_ratio
    cosine = math.cos(variant.pair.basic_rack.pressure_angle)
    ratios = {
        "zones exchanged": (
            2.0 * math.floor(ratio) + 1.0 - ratio,
            "the zones of contact with more and with fewer tooth pairs exchanged",
        ),
        "circular pitch": (
            ratio * cosine,
            "the circular pitch in place of the base pitch in the contact ratio",
        ),
        "halves": (
            math.floor(ratio) + 0.5,
            "one tooth pair more for half of the mesh cycle, as in a square wave",
        ),
    }
    return [
        _changed(
            f"{label}{ending}",
            f"{words}: a contact ratio of {value:.3f}{text}",
            _path(-(1.0 - share) * (value - ratio), share * (value - ratio)),
        )
        for label, (value, words) in ratios.items()
        for ending, text, share in (
            ("", ", from the true start of contact", 1.0),
            (", about the middle", ", about the middle of the path", 0.5),
            # Approach and recess in the same ratio: positions over the circular pitch.
            (", about the pitch point", ", about the pitch point", recess_share(variant.pair)),
        )
        if share in (0.5, 1.0) or label == "circular pitch"
        if value >= 1.0 and abs(value - ratio) > _APART
    ]


def recess_share(pair: GearPair) -> float:
    """Return the share of the path of contact behind the pitch point."""
    g = pair.geometry
    return (g.L_XD - g.L_XP) / (g.L_XD - g.L_XA)


def _lines_of_action(problem: Problem, variant: Variant) -> list[Choice]:
    """Other lines of action: at the pressure angle of the rack, and with other tip circles."""
    pair = variant.pair
    if not may_vary(problem, variant) or pair.shafts is not None:
        return []
    g = pair.geometry
    rack = pair.basic_rack
    addendum = rack.addendum_coefficient * rack.module
    shifts = pair.profile_shifts
    unshifted = [radius + addendum for radius in reference_radii(pair)]
    full = [radius + shift * rack.module for radius, shift in zip(unshifted, shifts, strict=True)]
    without = [tip - shift * rack.module for tip, shift in zip(tip_radii(pair), shifts, strict=True)]
    length = (g.base_radius_pinion + g.base_radius_gear) * math.tan(rack.pressure_angle)
    lines = {
        "of the rack": (length, tip_radii(pair), "a line of action at the pressure angle of the rack"),
        "of the rack, full tips": (
            length,
            full,
            "a line of action at the pressure angle of the rack, with tips that are not shortened",
        ),
        "of the rack, tips without shift": (
            length,
            unshifted,
            "a line of action at the pressure angle of the rack, with tips of gears without profile shift",
        ),
        "full tips": (g.L_XY, full, "tip circles that are not shortened"),
        "tips without shift": (g.L_XY, without, "tip circles that lack the profile shift"),
        "tips of the rack": (g.L_XY, unshifted, "tip circles of gears without profile shift"),
    }
    choices = []
    for label, (whole, tips, words) in lines.items():
        if label.startswith("of the rack") and abs(whole - g.L_XY) / g.base_pitch < _APART:
            continue  # shifts that balance: the line is the same
        reaches = [
            math.sqrt(tip**2 - base**2)
            for tip, base in zip(tips, (g.base_radius_pinion, g.base_radius_gear), strict=True)
        ]
        start = (whole - reaches[1] - g.L_XA) / g.base_pitch
        end = (reaches[0] - g.L_XD) / g.base_pitch
        if max(abs(start), abs(end), abs(whole - g.L_XY) / g.base_pitch) < _APART:
            continue

        def change(
            one: Variant, start: float = start, end: float = end, other: bool = whole != g.L_XY
        ) -> Variant:
            moved = with_ends_of(one, end - start).with_physics(path_start=start, path_end=end)
            if not other or one.pair.friction.law == "none":
                return moved
            return moved.with_physics(course="line of the rack", arms="line of the rack")

        choices.append(_changed(label, words, change))
    return choices


def _parts(problem: Problem, variant: Variant) -> list[Choice]:
    """Parts of the compliance of the energy method left out, halved or doubled."""
    if not isinstance(variant.pair.mesh.stiffness, EnergyStiffness) or not may_vary(problem, variant):
        return []

    def change(label: Compliance) -> Callable[[Variant], Variant]:
        return lambda one: one.with_physics(compliance=label)

    return [_changed(label, factors.words, change(label)) for label, factors in COMPLIANCES.items()]


def _tables(problem: Problem, variant: Variant) -> list[Choice]:
    """The stiffness of the mesh from a table that is too coarse."""
    if not may_vary(problem, variant):
        return []

    def change(entries: int, join: TableJoin, *, friction: bool = False) -> Callable[[Variant], Variant]:
        return lambda one: one.with_physics(table=entries, table_join=join, table_of_friction=friction)

    def of_pair(entries: int) -> Callable[[Variant], Variant]:
        return lambda one: one.with_physics(pair_table=entries)

    choices = [
        _changed(
            f"{entries}, {join}",
            f"a table of {entries} entries of the mesh stiffness over the mesh cycle, {_JOINED[join]}",
            change(entries, join),
        )
        for join, counts in _TABLES.items()
        for entries in counts
    ]
    if variant.pair.friction.law != "none":
        choices += [
            _changed(
                f"{entries}, {join}, friction too",
                f"a table of {entries} entries a mesh cycle of stiffness and friction, {_JOINED[join]}",
                change(entries, join, friction=True),
            )
            for join in _OF_FRICTION_TOO
            for entries in _TABLES_WITH_FRICTION
        ]
    choices += [
        _changed(
            f"{abs(entries)} of a tooth pair{', zero at A' if entries < 0 else ''}",
            f"a table of {abs(entries)} entries a base pitch of the stiffness of a tooth pair, joined by "
            f"straight lines{', zero at A and behind D' if entries < 0 else ', zero behind D'}",
            of_pair(entries),
        )
        for entries in _PAIR_TABLES
    ]
    return choices


def _pairs_at_most(problem: Problem, variant: Variant) -> list[Choice]:
    """Fewer tooth pairs than touch, or a last pair that stays too long."""
    if not may_vary(problem, variant):
        return []

    def change(most: int) -> Callable[[Variant], Variant]:
        return lambda one: one.with_physics(most_pairs=most)

    texts = {1: "one tooth pair", 2: "two tooth pairs", 3: "three tooth pairs"}
    ratio = variant.pair.geometry.contact_ratio
    choices = [
        _changed(
            f"{which} {count}", f"{texts[count]} at most that carry load, the {which}", change(sign * count)
        )
        for count in texts
        if count < ratio
        for which, sign in (("newest", 1), ("oldest", -1))
    ]
    if math.ceil(ratio) - ratio > _APART:
        words = "a tooth pair that keeps its last stiffness behind D, up to the next whole mesh cycle"
        choices.append(_changed("last one held", words, lambda one: one.with_physics(last_value_held=True)))
    return choices


def _bearings_in_series(problem: Problem, variant: Variant) -> list[Choice]:
    """The compliance of the bearings counted twice, in the mesh stiffness too."""
    if not may_vary(problem, variant) or variant.pair.shafts is not None:
        return []
    words = "a mesh stiffness with the compliance of the bearings in it, which stands beside it once more"
    return [_changed("in series", words, lambda one: one.with_physics(bearings_in_series=True))]


def _takes_series(problem: Problem, variant: Variant) -> bool:
    """Whether a compliance in series differs from a factor on the stiffness."""
    return may_vary(problem, variant) and variant.pair.mesh.stiffness.model != "rectangular"


def _is_parabola(problem: Problem, variant: Variant) -> bool:
    return isinstance(variant.pair.mesh.stiffness, ParabolicStiffness) and may_vary(problem, variant)


def _peak_of_parabola(problem: Problem, variant: Variant) -> list[Choice]:
    """A parabola whose peak is at the pitch point."""
    g = variant.pair.geometry
    shift = (2.0 * g.L_XP - g.L_XA - g.L_XD) / (g.L_XD - g.L_XA)
    if not _is_parabola(problem, variant) or abs(shift) < _APART:
        return []
    words = "a parabola of the stiffness with its peak at the pitch point"
    return [_changed("pitch point", words, lambda one: one.with_physics(peak=shift))]


def _causes() -> Iterator[Cause]:
    def fixed(
        name: str, meaning: str, span: str, choices: Callable[[Problem, Variant], Sequence[Choice]]
    ) -> Cause:
        return Cause(name, Kind.PHYSICS, meaning, span, choices)

    def free(
        name: str,
        meaning: str,
        span: str,
        grid: tuple[float, ...],
        change: Callable[[Variant, float], Variant],
        applies: Callable[[Problem, Variant], bool] = may_vary,
        describes: bool = False,
    ) -> Cause:
        return Cause(
            name=name,
            kind=Kind.PHYSICS,
            meaning=meaning,
            span=span,
            grid=grid,
            neutral=0.0,
            change=lambda variant, value: change(with_prescribed_contact(variant), value),
            words=f"{meaning}: {{value}}",
            applies=applies,
            describes=describes,
        )

    pitches = f"about {_ENDS[0]:g} to {_ENDS[-1]:g} base pitches"
    yield fixed(
        "zones of contact",
        "another contact ratio: zones exchanged, of equal length, the circular pitch for the base pitch",
        "zones exchanged, circular pitch, halves; from A, about the middle, about the pitch point",
        _contact_ratio,
    )
    yield fixed(
        "line of action",
        "a line of action at the pressure angle of the rack, or with other tip circles",
        "of the rack; tips not shortened, without shift, of the rack",
        _lines_of_action,
    )
    yield fixed(
        "parts of the compliance",
        "a part of the compliance of the energy method left out, or times a factor",
        "bending, shear, compression, foundation, contact (0, 0.25, 0.5, 2, 4); one tooth",
        _parts,
    )
    yield fixed(
        "table of the stiffness",
        "a table of the stiffness of the mesh, or of a tooth pair, that is too coarse",
        f"{_TABLES['lines'][0]} to {_TABLES['steps'][-1]} entries a mesh cycle; lines, steps, splines; with "
        "friction",
        _tables,
    )
    yield fixed(
        "number of pairs that carry",
        "fewer tooth pairs that carry load than touch, or a last one that stays too long",
        "one, two or three at most: the newest, the oldest; last one held",
        _pairs_at_most,
    )
    yield fixed(
        "bearings in the mesh stiffness",
        "a mesh stiffness that has the compliance of the bearings in it",
        "in series",
        _bearings_in_series,
    )
    yield fixed(
        "peak at the pitch point",
        "a parabola of the stiffness whose peak is at the pitch point",
        "pitch point",
        _peak_of_parabola,
    )
    yield free(
        "peak of the parabola",
        "the peak of the parabola of the stiffness further along, in half paths",
        f"about {_PEAKS[0]:g} to {_PEAKS[-1]:g}",
        _PEAKS,
        lambda variant, value: variant.with_physics(peak=value),
        _is_parabola,
        describes=True,
    )
    yield free(
        "compliance in series",
        "a further compliance of each tooth pair, over that of its mean stiffness",
        f"about {_SERIES[0]:g} to {_SERIES[-1]:g}",
        _SERIES,
        lambda variant, value: variant.with_physics(series=value),
        _takes_series,
    )
    yield free(
        "contact ratio",
        "the contact ratio larger, about the middle of the path, by",
        pitches,
        _ENDS,
        lambda variant, value: variant.with_physics(path_start=-0.5 * value, path_end=0.5 * value),
    )
    yield free(
        "end of the path of contact",
        "a path of contact that ends later, in base pitches",
        pitches,
        _ENDS,
        lambda variant, value: variant.with_physics(path_end=value),
    )
    yield free(
        "start of the path of contact",
        "a path of contact that starts later, in base pitches",
        pitches,
        _ENDS,
        lambda variant, value: variant.with_physics(path_start=value),
    )


#: Causes that alter the path of contact and the origin of the stiffness.
OF_PATH = tuple(_causes())
