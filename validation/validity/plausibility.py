"""Sentences on implausible values of a parameter file, each with the likely cause. The computation goes on.

Sources: a Hertzian pressure of about 4.2 GPa leaves a permanent indentation in bearing steel (ISO 76:2006).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from lumped.errors import ParameterError
from lumped.path_of_contact.friction import contact_path
from lumped.path_of_contact.stiffness import mesh_stiffness
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.shafts.equivalents import condensed_bearings

#: Hertzian pressure that no steel bears [Pa].
_PRESSURE = 4.2e9
#: Share of the module that a loaded mesh may give way.
_GIVES_WAY = 0.1
#: Backlash of teeth that are to have none, over the module: the rounding of lengths.
_ROUNDING = 1e-9
#: Oscillations of the fastest mode in a mesh cycle from which on the multibody model takes minutes a cycle.
_OSCILLATIONS = 1000.0
#: Speed below which a point that parts thousands is likelier than the speed [rpm], and one below which turns
#: a second may be meant [rpm]; speeds of the pitch line below and above those of gears in use [m/s].
_SLOW = 5.0
_SLOWLY = 120.0
_CREEPING = 0.5
_FASTEST = 200.0
#: Face width in modules, narrower and wider than that of any gear in use.
_NARROW = 0.5
_WIDE = 100.0
#: Springs and shafts are not of one machine where their stiffness differs by more than this factor.
_FAR = 2.0
_SOFT = ("N/m", 1.0, 2e6, math.inf, "is softer than any gear shaft. Given in N/um? Then write '{:g} N/um'.")
_THIN = ("um", 1e6, 0.5, math.inf, "is less than can be made. Given in mm? Then write '{:g} mm'.")
#: Field -> unit, factor to it, least and greatest value of gears in use, what a value beyond them means.
_SIZES = {
    "bearings.{}.loa_stiffness": _SOFT,
    "bearings.{}.oloa_stiffness": _SOFT,
    "{}.youngs_modulus": ("GPa", 1e-9, 0.5, 800.0, "is no material of gears (steel 206, plastics 1 to 10). "
                          "Given in another unit? Write it: '206000 MPa'."),
    "{}.roughness": ("um", 1e6, 0.01, 12.5, "is that of no flank (0.1 to 3 um). Write a number in um, or "
                     "text with its unit: '0.4 um'."),
    "{}.tip_relief.amount": _THIN,
    "{}.root_relief.amount": _THIN,
}  # fmt: skip


def parameter_warnings(pair: GearPair) -> tuple[str, ...]:
    """Return one sentence for each implausible value: field, value, likely cause."""
    return (
        *_sizes(pair),
        *_frequencies(pair),
        *_shafts(pair),
        *_widths(pair),
        *_load(pair),
        *_speed(pair),
        *_roughness(pair),
    )


def _sizes(pair: GearPair) -> Iterator[str]:
    """Values beyond those of any gear in use."""
    for pattern, (unit, factor, low, high, words) in _SIZES.items():
        for gear in ("pinion", "gear"):
            path = pattern.format(gear)
            value_at_path: Any = pair
            for key in path.split("."):
                value_at_path = getattr(value_at_path, key, None)  # no relief, no amount
            value = factor * (value_at_path or 0.0)
            if value and not low <= value <= high:
                yield f"{path} = {value:g} {unit} {words.format(value)}"


def _frequencies(pair: GearPair) -> Iterator[str]:
    """Sentence on a fastest mode that makes the multibody model slow."""
    fastest = math.sqrt(max(_squared_frequencies(pair)))
    oscillations = fastest * pair.geometry.mesh_period / (2.0 * math.pi)
    if oscillations > _OSCILLATIONS:
        yield (
            f"The fastest mode swings {oscillations:.2g} times in a mesh cycle: the multibody model needs "
            f"some {30 * oscillations:.1g} evaluations a cycle. Check stiffness and speed."
        )


def _shafts(pair: GearPair) -> Iterator[str]:
    """Sentence on the spring of the 6-DOF model that differs most from the stiffness of the shafts."""
    if pair.shafts is None:
        return
    condensed = condensed_bearings(pair)
    differences = []
    for name in ("pinion", "gear"):
        for field in ("loa_stiffness", "oloa_stiffness"):
            stated, static = (getattr(getattr(one.bearings, name), field) for one in (pair, condensed))
            line = "along" if field.startswith("loa") else "off"
            differences.append(
                (abs(math.log(stated / static)), f"{name} has {stated:.3g} N/m {line}", static)
            )
    ratio, springs, static = max(differences)
    if ratio > math.log(_FAR):
        yield (
            "Jumps, and what else is computed on the springs of [bearings], is not of the shafts: "
            f"the {springs} the line of action there, on its shaft {static:.3g} N/m. "
            "lumped.condensed_bearings gives springs that stand for the shafts."
        )


def _squared_frequencies(pair: GearPair) -> Iterator[float]:
    """Upper bounds of the squared frequencies [rad^2/s^2]: all springs of one coordinate over its mass."""
    b = bodies_of(pair)
    g = pair.geometry
    mesh = float(mesh_stiffness(pair).attrs["mean"])
    for bearing, mass in ((pair.bearings.pinion, b.mass_pinion), (pair.bearings.gear, b.mass_gear)):
        yield (bearing.loa_stiffness + mesh) / mass
        yield bearing.oloa_stiffness / mass
    yield mesh * (g.base_radius_pinion**2 / b.inertia_pinion + g.base_radius_gear**2 / b.inertia_gear)


def _widths(pair: GearPair) -> Iterator[str]:
    """Sentences on face widths in modules."""
    for name in ("pinion", "gear"):
        width = getattr(pair, name).face_width
        modules = width / pair.basic_rack.module
        if not _NARROW <= modules <= _WIDE:
            cause = f"Given in m? Then write '{width * 1e3:g} m'." if modules < 1.0 else "Check its unit."
            yield f"{name}.face_width = {width * 1e3:g} mm is {modules:.2g} modules (gears: 5 to 40). {cause}"


def _load(pair: GearPair) -> Iterator[str]:
    """Sentences on the pressure and the deflection at the operating torque."""
    g = pair.geometry
    operating = pair.operating
    force = operating.pinion_torque / g.base_radius_pinion
    path = contact_path(pair)
    pressure = float(path.hertz_pressure(path.L_XP))  # type: ignore[arg-type]
    give = force / float(mesh_stiffness(pair).attrs["mean"])
    torque = f"operating.pinion_torque = {operating.pinion_torque:g} N m"
    if pressure > _PRESSURE:
        yield f"{torque} presses the flanks with {pressure * 1e-9:.3g} GPa, beyond any steel. {_cause(pair)}"
    if give > _GIVES_WAY * pair.basic_rack.module:
        yield (
            f"{torque} makes the teeth give way by {give * 1e3:.3g} mm, more than a tenth of the module. "
            "Check torque, face width and Young's modulus, and their units."
        )
    elif _ROUNDING * pair.basic_rack.module < g.normal_backlash < give:
        yield (
            f"{torque} makes the teeth give way by {give * 1e6:.3g} um, more than the backlash of "
            f"{g.normal_backlash * 1e6:.3g} um: the backs of the teeth would touch. Check mesh.backlash."
        )


def _cause(pair: GearPair) -> str:
    """Likely cause: swapped speed and torque where the exchange gives a plausible pair, else units."""
    rpm = pair.operating.pinion_speed * 30.0 / math.pi
    torque = float(pair.operating.pinion_torque)
    try:
        swapped = pair.with_({"operating.pinion_speed": torque, "operating.pinion_torque": rpm})
        path = contact_path(swapped)
        fits = float(path.hertz_pressure(path.L_XP)) < 0.5 * _PRESSURE  # type: ignore[arg-type]
    except (ParameterError, TypeError):
        fits = False
    return "Speed and torque swapped?" if fits else "Check torque, face width and module, and their units."


def _speed(pair: GearPair) -> Iterator[str]:
    """Sentences on the pinion speed."""
    rpm = pair.operating.pinion_speed * 30.0 / math.pi
    if rpm < _SLOW:
        yield f"operating.pinion_speed = {rpm:g} rpm: does a point part thousands? Then write {1e3 * rpm:g}."
        return
    pitch_line = pair.geometry.pitch_line_velocity
    text = f"operating.pinion_speed = {rpm:g} rpm moves the pitch line at {pitch_line:.3g} m/s"
    if rpm < _SLOWLY and pitch_line < _CREEPING:
        yield f"{text}, slower than most gears. Turns a second meant? Then write '{rpm:g} Hz'."
    elif pitch_line > _FASTEST:
        yield f"{text}, faster than any gears. Is {rpm / 60.0:g} the speed in rpm? Then write it without Hz."


def _roughness(pair: GearPair) -> Iterator[str]:
    """Sentence on a composite roughness that differs from both flanks."""
    stated = pair.friction.composite_roughness
    both = math.hypot(pair.pinion.roughness, pair.gear.roughness)
    if stated is not None and abs(stated - both) > 0.05 * both:
        yield (
            f"friction.composite_roughness = {stated * 1e6:.3g} um is used for the film, not the root sum "
            f"square {both * 1e6:.3g} um of both roughnesses. Delete it if the roughnesses are meant."
        )
