"""Explanations that read the curves of the other model in another way.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from validation.check.curves import Channel
from validation.check.explanations.cause import Cause, Choice, Kind, Variant
from validation.check.explanations.radius_readings import (
    ANGLES,
    groups,
    radii_of_channels,
    reading_choice,
)
from validation.check.explanations.reading import (
    Reading,
    refined_curves_fit,
    turning_channels,
)
from validation.check.mesh_frequency import factors_of_times
from validation.check.problem import Problem
from validation.check.quantities import GEARS, LINES, PLACES, QUANTITIES, Quantity, quantity_of


class UnitFactor(NamedTuple):
    """A factor by which units and definitions are mistaken.

    Attributes
    ----------
    words : the mistake
    factor : factor that the values have too much
    units : beginnings of the SI units that the mistake concerns; empty: every unit
    """

    words: str
    factor: float
    units: tuple[str, ...] = ()


UNIT_FACTORS = (
    UnitFactor("thousandths of the unit", 1e3),
    UnitFactor("millionths of the unit", 1e6),
    UnitFactor("thousands of the unit", 1e-3),
    UnitFactor("millions of the unit", 1e-6),
    UnitFactor("degrees for radians", 180.0 / math.pi, ("rad",)),
    UnitFactor("radians for degrees", math.pi / 180.0, ("rad",)),
    UnitFactor("turns for radians", 1.0 / (2.0 * math.pi), ("rad",)),
    UnitFactor("radians for turns", 2.0 * math.pi, ("rad",)),
    UnitFactor("rpm for rad/s", 30.0 / math.pi, ("rad/s",)),
    UnitFactor("arc minutes for radians", 180.0 * 60.0 / math.pi, ("rad",)),
    UnitFactor("arc seconds for radians", 180.0 * 3600.0 / math.pi, ("rad",)),
    UnitFactor("inches for metres", 1.0 / 0.0254, ("m",)),
    UnitFactor("thousandths of an inch for metres", 1e3 / 0.0254, ("m",)),
    UnitFactor("millionths of an inch for metres", 1e6 / 0.0254, ("m",)),
    UnitFactor("multiples of g for m/s^2", 1.0 / 9.80665, ("m/s^2",)),
    UnitFactor("pound-force inches for N m", 1.0 / 0.1129848, ("N*m",)),
    UnitFactor("kilogram-force for newtons", 1.0 / 9.80665, ("N",)),
    UnitFactor("pounds for newtons", 1.0 / 4.4482216, ("N",)),
    UnitFactor("twice the value: diameter for radius, or peak to peak for amplitude", 2.0),
    UnitFactor("half the value: radius for diameter, or amplitude for peak to peak", 0.5),
    UnitFactor("rms for peak", 1.0 / math.sqrt(2.0)),
    UnitFactor("peak for rms", math.sqrt(2.0)),
)
#: A unit is tried where it brings the sizes of both motions nearer to each other by this factor.
_NEARER = 1.2
#: A unit factor that is nearer to 1 than this is vague: other causes change a channel by as much.
VAGUE = 15.0
#: A factor that is not vague must take this share of the distance between the sizes away.
_TAKES = 0.5
#: More channels than this are not swapped pair by pair.
_MOST_SWAPPED = 12
#: Time constant of a low-pass filter: mesh cycles over 2 pi. Delay: mesh cycles.
_TIME_CONSTANT = (0.125, 0.25, 0.5, 1.0, 2.0)
#: Orders above the last one of the curves: at most so much of theirs, and at least so much of ours.
_NOTHING, _SOMETHING = 1e-3, 0.01
_WINDOW = (0.05, 0.1, 0.2, 0.35, 0.5)
#: Trial angles of axes over a right angle [rad].
_TURNED = (-1.0, -0.78, -0.5, -0.22, 0.22, 0.5, 0.78, 1.0)
_QUARTER = 0.5 * math.pi
_HIGH_PASS = (0.1, 0.3, 1.0, 3.0)
#: Means that differ by this share of the static value.
_OTHER_MEAN = 0.02
#: Difference of the means of the transmission error that is half of the backlash, up to this share.
_HALF_BACKLASH = 0.05
_DELAY = (-0.15, -0.05, 0.05, 0.15)


def _signs(problem: Problem, variant: Variant) -> list[Choice]:
    def turned(names: Sequence[str]) -> Callable[[Reading], Reading]:
        return lambda reading: reading.with_factors(dict.fromkeys(names, -1.0))

    return [
        reading_choice(words, f"the sign of {words} reversed", turned(names))
        for words, names in groups(problem).items()
    ]


def _units(problem: Problem, variant: Variant) -> list[Choice]:
    """Unit factors of each group that bring the sizes of the motions nearer to each other."""
    rows = problem.misfit.channels
    before = dict(variant.reading.factors)
    ratios = {}
    for row in rows:
        theirs = math.hypot(row.channel.orders.size, row.channel.orders.mean if row.compares_mean else 0.0)
        ours = math.hypot(row.ours.size, row.ours.mean if row.compares_mean else 0.0)
        name = row.channel.channel.name
        ratios[name] = theirs / abs(before.get(name, 1.0)) / ours if theirs > 0.0 and ours > 0.0 else 1.0

    def times(names: Sequence[str], factor: float) -> Callable[[Reading], Reading]:
        return lambda reading: reading.with_factors(dict.fromkeys(names, factor))

    choices = []
    kinds = {channel.name: channel.kind.unit for channel in problem.curves.channels}
    for words, group in groups(problem).items():
        names = tuple(name for name in group if name in ratios)
        if not names:  # no channel of the group is compared
            continue
        distance = max(abs(math.log(ratios[name])) for name in names)
        for unit in UNIT_FACTORS:
            if unit.units and not all(kinds[name].startswith(unit.units) for name in names):
                continue
            factor = unit.factor
            nearer = max(abs(math.log(ratios[name] / factor)) for name in names)
            vague = abs(math.log(factor)) < math.log(VAGUE)
            if nearer < (distance - math.log(_NEARER) if vague else (1.0 - _TAKES) * distance):
                label = f"{words}: {factor:.6g}"
                text = f"{words} {factor:.4g} times too large ({unit.words})"
                choice = reading_choice(label, text, times(names, factor))
                choices.append(choice._replace(vague=vague))
    return choices


def _swapped(problem: Problem, variant: Variant) -> list[Choice]:
    """Two channels of the same unit swapped; all of the pinion with all of the gear."""
    channels = problem.curves.channels
    quantities = {channel.name: channel.quantity for channel in channels}
    choices = []

    def becoming(changes: dict[str, str]) -> Callable[[Reading], Reading]:
        return lambda reading: reading.with_quantities(changes)

    by_quantity = {channel.quantity: channel.name for channel in channels}
    for words, exchange in (("pinion and gear", _other_gear), ("both directions", _other_line)):
        changes = {
            name: exchange(quantity)
            for name, quantity in quantities.items()
            if exchange(quantity) != quantity and exchange(quantity) in by_quantity
        }
        if len(changes) > 2:
            text = f"the channels of {words} swapped"
            choices.append(reading_choice(f"all of {words}", text, becoming(changes)))
    if len(channels) > _MOST_SWAPPED:
        return choices
    for one, other in itertools.combinations(channels, 2):
        same = one.kind.unit == other.kind.unit and one.kind.of_tooth_pair == other.kind.of_tooth_pair
        if same and one.quantity != other.quantity:
            changes = {one.name: other.quantity, other.name: one.quantity}
            text = f"the channels {one.name} and {other.name} swapped"
            choices.append(reading_choice(f"{one.name} and {other.name}", text, becoming(changes)))
    return choices


def exchanged_gears(problem: Problem, reading: Reading) -> Reading:
    """Return a reading in which each channel of a gear holds the same quantity of the other gear."""
    before = dict(reading.quantities)
    names = {one.name: before.get(one.name, one.quantity) for one in problem.curves.channels}
    return reading.with_quantities({name: _other_gear(quantity) for name, quantity in names.items()})


def _other_gear(quantity: str) -> str:
    """Name of the same quantity of the other gear."""
    stem, _, ending = quantity.partition("_dot") if "_dot" in quantity else quantity.partition("_ddot")
    middle = quantity[len(stem) : len(quantity) - len(ending)]
    (one, _), (other, _) = GEARS
    exchanged = {f"_{one}": f"_{other}", f"_{other}": f"_{one}"}.get(stem[-2:])
    return quantity if exchanged is None else stem[:-2] + exchanged + middle + ending


def _other_line(quantity: str) -> str:
    """Name of the same quantity in the other direction."""
    (one, _), (other, _) = LINES
    if quantity.startswith("bearing_force_"):
        return "bearing_force_" + _other_line(quantity.removeprefix("bearing_force_"))
    exchanged = {f"{one}_": f"{other}_", f"{other}_": f"{one}_"}.get(quantity[:2])
    return quantity if exchanged is None else exchanged + quantity[2:]


def _other_quantities(problem: Problem, variant: Variant) -> list[Choice]:
    """Channels that hold another quantity than their names say: each alone, and all with the same mistake."""
    choices = []
    alike: dict[str, dict[str, tuple[str, float]]] = {}
    quantities = dict(variant.reading.quantities)
    for channel in problem.curves.channels:
        kind = quantity_of(quantities.get(channel.name, channel.quantity))
        mistaken = list(_mistaken(problem, kind))
        unread = not channel.kind.is_rotation and channel.name not in quantities
        if unread and _has_one_sign(problem, channel):
            mistaken.append(("the magnitude, without sign,", f"|{kind.name}|", 1.0))
        for words, quantity, factor in mistaken:

            def change(
                reading: Reading, name: str = channel.name, quantity: str = quantity, factor: float = factor
            ) -> Reading:
                return reading.with_quantities({name: quantity}).with_factors({name: factor})

            label = f"{channel.name}: {words}"
            choices.append(reading_choice(label, f"{words} in the channel {channel.name}", change))
            alike.setdefault(words, {})[channel.name] = quantity, factor
    return choices + [_all_alike(words, channels) for words, channels in alike.items() if len(channels) > 1]


def _all_alike(words: str, channels: Mapping[str, tuple[str, float]]) -> Choice:
    """Several channels with the same mistake; of each the quantity, and the factor to its values."""
    quantities = {name: quantity for name, (quantity, _) in channels.items()}
    factors = {name: factor for name, (_, factor) in channels.items()}
    names = ", ".join(channels)
    return reading_choice(
        f"{names}: {words}",
        f"{words} in the channels {names}",
        lambda reading: reading.with_quantities(quantities).with_factors(factors),
    )


def _mistaken(problem: Problem, kind: Quantity) -> Iterator[tuple[str, str, float]]:
    """Words, quantity, and factor from that quantity to the values of the channel."""
    name = kind.name
    if name == "dte":
        cosine = math.cos(problem.pair.geometry.operating_pressure_angle)
        yield "the rotations without the displacements of the bearings", "dte of the rotations", 1.0
        yield (
            "the rotations on the pitch circle, without the displacements of the bearings",
            "dte of the rotations",
            1.0 / cosine,
        )
        g = problem.pair.geometry
        for gear, radius in (("pinion", g.base_radius_pinion), ("gear", g.base_radius_gear)):
            for unit, per_radian in {"radians": 1.0, **ANGLES}.items():
                words = f"the rotations alone, as an angle of the {gear} in {unit},"
                yield words, "dte of the rotations", per_radian / radius
        yield "the displacements of the bearings with the wrong sign", "dte with reversed displacements", 1.0
        yield "no displacement of the gear", "dte without the gear's", 1.0
        yield "no displacement of the pinion", "dte without the pinion's", 1.0
        yield "the sum of both displacements in place of their difference", "dte with a sum", 1.0
        yield "rotations on the pitch circles beside the displacements", "dte on the pitch circles", 1.0
        if _perfect_and_prescribed(problem):
            yield "the transmission error less the static one", "dte less the static one", 1.0
    stem = name.removesuffix("_ddot").removesuffix("_dot")
    others = [stem, f"{stem}_dot", f"{stem}_ddot"]
    nouns = ("the motion itself", "the rate", "the acceleration")
    for words, other in zip(nouns, others, strict=True):
        if other != name and f"{stem}_dot" in QUANTITIES and other in QUANTITIES:
            yield words, other, 1.0
    if name.startswith("bearing_force_"):
        motion = name.removeprefix("bearing_force_")
        yield "the displacement", motion, 1.0
        yield "the resultant of both directions", f"resultant bearing force {motion[-1]}", 1.0
        if problem.pair.shafts is None:
            bearing = getattr(problem.pair.bearings, "pinion" if motion.endswith("_p") else "gear")
            stiffness = bearing.loa_stiffness if motion.startswith("x") else bearing.oloa_stiffness
            yield "stiffness times displacement, without the damper", motion, -stiffness
    elif stem[:2] in ("x_", "y_") and not kind.derivative:
        yield "the bearing force", f"bearing_force_{stem}", 1.0
    if name == "mesh_force":
        yield "the friction force", "friction", 1.0
        for words, row in (("newest", _rows(problem) - 1), ("leading", 0)):
            yield f"the load of the {words} tooth pair alone", f"normal_load in place {row}", 1.0
        if _perfect_and_prescribed(problem):
            yield "stiffness times deflection, without the dampers", "mesh force of the springs", 1.0
    if name == "normal_load":
        yield "the mesh force in equal shares", "equal share of the load", 1.0
        yield "the whole mesh force", "whole load of the mesh", 1.0
        yield "the share of the momentary mesh force, times the static one", "share of the static load", 1.0
        yield "the load times its share of the mesh force once more", "load times its share", 1.0
        yield "the friction force", "friction_force", 1.0
    if name == "friction_force":
        yield "the normal load", "normal_load", 1.0
    if name == "friction":
        yield "the sum of the sizes, without signs,", "friction without signs", 1.0
        yield "the mesh force", "mesh_force", 1.0
        yield "the friction of the newest pair alone", f"friction_force in place {_rows(problem) - 1}", 1.0
    if name.startswith("mesh_torque"):
        yield "the mesh force", "mesh_force", 1.0


def _rows(problem: Problem) -> int:
    """Number of places of tooth pairs at one time; the pair ahead is first."""
    return int(problem.motion.motion["normal_load"].shape[0])


def _places(problem: Problem, variant: Variant) -> list[Choice]:
    """Channels of tooth pairs that show a place of the mesh, which another pair takes in every mesh cycle."""
    rows = _rows(problem)
    names = [one.name for one in problem.curves.channels if one.kind.of_tooth_pair]
    if not names or variant.reading.places or rows > PLACES:
        return []
    return [
        reading_choice(
            label,
            f"places of the mesh in the channels of tooth pairs, {label}, not the same pair all the time",
            partial(replace, places=label),
        )
        for label in ("newest pair first", "leading pair first")
    ]


def _perfect_and_prescribed(problem: Problem) -> bool:
    """Whether the mesh force of the springs is the stiffness of the mesh times the transmission error."""
    pair = problem.pair
    return pair.mesh.contact == "prescribed" and pair.healthy is pair


def _has_one_sign(problem: Problem, channel: Channel) -> bool:
    """Whether a channel has one sign only and our motion has both: the channel may be a magnitude."""
    ours = problem.motion.samples(channel.quantity) if problem.motion.has(channel.quantity) else np.zeros(1)
    least, most = float(channel.values.min()), float(channel.values.max())
    return least * most >= 0.0 and float(ours.min()) * float(ours.max()) < 0.0


def _most_orders(problem: Problem, variant: Variant) -> list[Choice]:
    """The first mesh orders alone, where the curves have nothing above them and our motion has something."""
    rows = [row for row in problem.misfit.channels if row.channel.channel.tooth_pair is None]
    if not rows or variant.reading.most_orders:
        return []
    orders = rows[0].ours.orders
    for most in range(1, int(orders.max())):
        above = orders > most + 0.5
        theirs = max(float(np.linalg.norm(row.channel.orders.values[above])) / row.scale for row in rows)
        if theirs < _NOTHING:
            ours = max(float(np.linalg.norm(row.ours.values[above])) / row.scale for row in rows)
            if ours < _SOMETHING:
                return []
            words = f"the first {most} mesh orders alone" if most > 1 else "the first mesh order alone"
            return [reading_choice(most, words, partial(replace, most_orders=most))]
    return []


def _offsets(problem: Problem, variant: Variant) -> list[Choice]:
    """Channels, or families of them, with another zero; only where their means differ."""
    differing = {
        row.channel.channel.name
        for row in problem.misfit.channels
        if row.compares_mean and abs(row.channel.orders.mean - row.ours.mean) > _OTHER_MEAN * row.static
    } - {*variant.reading.offsets}

    def without_means(names: Sequence[str]) -> Callable[[Reading], Reading]:
        return lambda reading: reading.with_offsets(names)

    half = 0.5 * problem.pair.mesh.backlash
    dead_zone = [
        reading_choice(
            f"{row.channel.channel.name}: half of the backlash",
            "a dead zone of the backlash about zero, so that teeth touch at half of the backlash",
            without_means((row.channel.channel.name,)),
        )
        for row in problem.misfit.channels
        if row.channel.channel.name in differing and row.channel.channel.quantity == "dte"
        if abs(abs(row.channel.orders.mean - row.ours.mean) - half) < _HALF_BACKLASH * half
    ]
    explained = {"dte"} if dead_zone else set()
    return dead_zone + [
        reading_choice(words, f"another zero of {words}: the means differ", without_means(names))._replace(
            vague=True
        )
        for words, names in groups(problem).items()
        if differing & {*names} and not explained & {*names}
    ]


def _reversed(problem: Problem, variant: Variant) -> list[Choice]:
    turned = not variant.reading.reversed
    return [reading_choice("reversed", "time that runs backwards", lambda r: replace(r, reversed=turned))]


def _step(problem: Problem, variant: Variant) -> list[Choice]:
    if problem.refined is None or not refined_curves_fit(problem.curves, problem.refined):
        return []
    words = "a step of integration that is too long: half the step gives other curves"
    return [reading_choice("half the step", words, lambda reading: replace(reading, refined=True))]


def _phase(problem: Problem, variant: Variant) -> list[Choice]:
    if problem.given_shift is None:
        return []
    words = "another phase than the stated one"
    return [reading_choice("searched", words, lambda reading: replace(reading, free_shift=True))]


def _time_axis(problem: Problem, variant: Variant) -> list[Choice]:
    """The time axis alone is wrong: the motion is at the speed of the pair."""
    factor = problem.frequency.factor
    if problem.curves.abscissa != "time" or (not problem.frequency.cause and abs(factor - 1.0) < 5e-3):
        return []
    words = f"a time axis {factor:.4g} times too fast, with the motion at the speed of the pair"
    if problem.frequency.cause in factors_of_times(problem.pair):
        words += f": {problem.frequency.cause}"
    return [reading_choice(1.0 / factor, words, lambda reading: reading)]


def causes_of_channels(problem: Problem) -> list[Cause]:
    """Return the free causes of each channel and family: a delay against the others, a filter of its own."""
    of_channels = groups(problem)
    every = len(problem.curves.channels)

    def late(names: Sequence[str]) -> Callable[[Variant, float], Variant]:
        return lambda variant, value: variant.with_reading(variant.reading.with_delay(names, value))

    def filtered(names: Sequence[str], *, second: bool) -> Callable[[Variant, float], Variant]:
        return lambda variant, value: variant.with_reading(
            variant.reading.with_filter(names, value, second=second)
        )

    def of_group(cause: Cause, words: str, change: Callable[[Variant, float], Variant], part: str) -> Cause:
        return replace(cause, words=words, change=change, applies=lambda problem, variant: True, part=part)

    some = {words: names for words, names in of_channels.items() if len(names) < every}
    return [
        *(
            of_group(DELAY, f"{words} {{value}} mesh cycles late against the others", late(names), words)
            for words, names in some.items()
        ),
        *(
            of_group(
                FILTER,
                f"a low-pass filter of {order} order of {words} alone, at {{value}} mesh orders",
                filtered(names, second=order == "second"),
                f"{words}, {order} order",
            )
            for words, names in some.items()
            for order in ("second", "first")
        ),
    ]


def _has_forces_to_turn(problem: Problem, variant: Variant) -> bool:
    return bool(turning_channels(problem.curves.channels, forces_only=True))


def _has_axes_to_turn(problem: Problem, variant: Variant) -> bool:
    every = turning_channels(problem.curves.channels, forces_only=False)
    return every != turning_channels(problem.curves.channels, forces_only=True)


#: A delay of one channel; ``causes_of_channels`` makes one cause for each channel of it.
DELAY = Cause(
    name="delay of a channel",
    kind=Kind.READING,
    meaning="one channel, or a family of channels, late against the others, as by a filter",
    span="-0.2 to 0.2 mesh cycles",
    grid=_DELAY,
    neutral=0.0,
    applies=lambda problem, variant: False,
)


#: A filter of some channels; ``causes_of_channels`` makes one cause for each of their groups.
FILTER = Cause(
    name="filter of a channel",
    kind=Kind.READING,
    meaning="one channel, or a family of channels, through a low-pass filter of first or second order",
    span="cutoff at 0.5 to 8 mesh orders and above",
    grid=_TIME_CONSTANT,
    neutral=0.0,
    shown=lambda value: 1.0 / max(value, 1e-300),
    applies=lambda problem, variant: False,
)


def _causes() -> Iterator[Cause]:
    def read(
        name: str, meaning: str, span: str, choices: Callable[[Problem, Variant], Sequence[Choice]]
    ) -> Cause:
        return Cause(name, Kind.READING, meaning, span, choices)

    yield read(
        "time axis",
        "times in another unit, angles or mesh cycles in their place, or times at another speed than the "
        "motion",
        "ratio of the frequencies",
        _time_axis,
    )
    yield read("sign of a channel", "a channel, or a family of channels, with the wrong sign", "-1", _signs)
    units = ", ".join(f"{unit.factor:.4g}" for unit in UNIT_FACTORS)
    yield read("unit of a channel", "a channel, or a family of channels, in another unit", units, _units)
    yield read(
        "radius of a channel",
        "an angle for a length, or of the other gear",
        "base radii, tip radii, ratio, cos(alpha); degrees, arc seconds, microradians",
        radii_of_channels,
    )
    yield read("channels swapped", "two channels swapped", "pairs of channels", _swapped)
    yield read(
        "another quantity",
        "a channel that holds another quantity",
        "displacement, rate, force; dte of the rotations alone",
        _other_quantities,
    )
    yield read(
        "places of tooth pairs",
        "channels of tooth pairs that show a place of the mesh, not one pair",
        "newest pair first, leading pair first",
        _places,
    )
    yield read(
        "zero of a channel",
        "a channel, or a family of channels, with another zero",
        "offset; half of the backlash",
        _offsets,
    )
    yield read("time reversed", "time that runs backwards", "reversed", _reversed)
    yield read("wrong phase", "another phase than the stated one", "searched", _phase)
    yield read("step too long", "a step of integration that is too long", "half the step", _step)
    yield Cause(
        name="low-pass filter",
        kind=Kind.READING,
        meaning="all channels through a low-pass filter of first order",
        span="cutoff at 0.5 to 8 mesh orders and above",
        grid=_TIME_CONSTANT,
        neutral=0.0,
        change=lambda variant, value: variant.with_reading(replace(variant.reading, time_constant=value)),
        words="a low-pass filter of first order at {value} mesh orders",
        shown=lambda value: 1.0 / max(value, 1e-300),
    )
    yield Cause(
        name="low-pass filter both ways",
        kind=Kind.READING,
        meaning="all channels through a low-pass filter that runs forward and backward, without delay",
        span="cutoff at 0.5 to 8 mesh orders and above",
        grid=_TIME_CONSTANT,
        neutral=0.0,
        change=lambda variant, value: variant.with_reading(replace(variant.reading, both_ways=value)),
        words="a low-pass filter of second order, forward and backward, at {value} mesh orders",
        shown=lambda value: 1.0 / max(value, 1e-300),
    )
    yield Cause(
        name="low-pass filter of second order",
        kind=Kind.READING,
        meaning="all channels through a low-pass filter of second order, as of Butterworth",
        span="cutoff at 0.5 to 8 mesh orders and above",
        grid=_TIME_CONSTANT,
        neutral=0.0,
        change=lambda variant, value: variant.with_reading(replace(variant.reading, second_order=value)),
        words="a low-pass filter of second order at {value} mesh orders",
        shown=lambda value: 1.0 / max(value, 1e-300),
    )
    yield Cause(
        name="low-pass filter of fourth order",
        kind=Kind.READING,
        meaning="all channels through a low-pass filter of fourth order, as of Butterworth",
        span="cutoff at 0.5 to 8 mesh orders and above",
        grid=_TIME_CONSTANT,
        neutral=0.0,
        change=lambda variant, value: variant.with_reading(replace(variant.reading, fourth_order=value)),
        words="a low-pass filter of fourth order at {value} mesh orders",
        shown=lambda value: 1.0 / max(value, 1e-300),
    )
    yield Cause(
        name="high-pass filter",
        kind=Kind.READING,
        meaning="all channels through a high-pass filter of first order",
        span="cutoff at 0.1 to 3 mesh orders",
        grid=_HIGH_PASS,
        neutral=0.0,
        change=lambda variant, value: variant.with_reading(replace(variant.reading, high_pass=value)),
        words="a high-pass filter of first order at {value} mesh orders",
    )
    yield read(
        "few mesh orders", "curves of the first mesh orders alone", "where the curves end", _most_orders
    )
    yield Cause(
        name="moving average",
        kind=Kind.READING,
        meaning="all channels through a moving average",
        span="window of 0.05 to 0.5 mesh cycles",
        grid=_WINDOW,
        neutral=0.0,
        change=lambda variant, value: variant.with_reading(replace(variant.reading, window=value)),
        words="a moving average over {value} mesh cycles",
    )
    yield Cause(
        name="axes of the bearing forces",
        kind=Kind.READING,
        meaning="bearing forces in axes that are turned from the line of action",
        span="-90 to 90 degrees",
        grid=_TURNED,
        neutral=0.0,
        change=lambda variant, value: variant.with_reading(
            replace(variant.reading, turned_forces=_QUARTER * value)
        ),
        words="axes of the bearing forces that are turned by {value} degrees from the line of action",
        shown=lambda value: 90.0 * value,
        applies=_has_forces_to_turn,
    )
    yield Cause(
        name="axes of all channels",
        kind=Kind.READING,
        meaning="displacements and bearing forces in axes that are turned from the line of action",
        span="-90 to 90 degrees",
        grid=_TURNED,
        neutral=0.0,
        change=lambda variant, value: variant.with_reading(
            replace(variant.reading, turned_axes=_QUARTER * value)
        ),
        words="axes of displacements and bearing forces that are turned by {value} degrees from the line of "
        "action",
        shown=lambda value: 90.0 * value,
        applies=_has_axes_to_turn,
    )
    yield DELAY
    yield FILTER


#: Causes that change the reading of the curves.
OF_READING = tuple(_causes())
