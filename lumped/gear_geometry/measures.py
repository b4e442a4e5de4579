"""What a gear drawing states and a shop measures: span, dimension over balls, and the table of a pair.

Sources: ISO 21771 (DIN 3960) for diameters, tooth thickness, generating profile shift, backlash and
clearance; DIN 21773 (before it DIN 3960, section 3.8) for the span over k teeth and the dimension over two
balls.

Teeth are measured as they are made. The thinning ``mesh.backlash`` is that of both gears together, along the
line of action; each gear is taken to have half of it. The span of each gear is then shorter than the
nominal one by half of ``mesh.backlash``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, fields, replace
from typing import Any, Protocol

from lumped.gear_geometry.geometry import Geometry, Wheel
from lumped.gear_geometry.tooth_profile import ToothProfile, inverse_involute, involute


def span(tooth: ToothProfile, teeth_spanned: int) -> float:
    """Return W_k, the base tangent length over k teeth [m].

    W_k = m cos(alpha) (pi (k - 1/2) + z inv(alpha)) + 2 x m sin(alpha)

    >>> wheel = ToothProfile(19, 1.75e-3, math.radians(20.0), 0.0, 1.25, 0.38)
    >>> round(1e3 * span(wheel, 3), 3)
    13.381
    """
    alpha = tooth.pressure_angle
    pitches = math.pi * (teeth_spanned - 0.5) + tooth.teeth * involute(alpha)
    return tooth.module * (math.cos(alpha) * pitches + 2.0 * tooth.profile_shift * math.sin(alpha))


def shift_from_span(tooth: ToothProfile, teeth_spanned: int, measured: float) -> float:
    """Return the profile shift coefficient of a gear with this span [m]: the inverse of `span`.

    The ``profile_shift`` of ``tooth`` is not read.
    """
    unshifted = span(replace(tooth, profile_shift=0.0), teeth_spanned)
    return (measured - unshifted) / (2.0 * tooth.module * math.sin(tooth.pressure_angle))


def teeth_spanned(tooth: ToothProfile, radius: float) -> int:
    """Return the number of teeth k, at least 2, whose span touches the flanks nearest to a circle.

    ``radius`` [m] is larger than the base radius. The planes touch on the circle where
    W_k = 2 sqrt(r^2 - r_b^2).
    """
    wanted = 2.0 * math.sqrt(radius**2 - tooth.base_radius**2)
    base_pitch = 2.0 * math.pi * tooth.base_radius / tooth.teeth
    return max(2, 2 + round((wanted - span(tooth, 2)) / base_pitch))


def ball_touching_at(tooth: ToothProfile, radius: float) -> float:
    """Return the diameter of the ball that touches both flanks of a space on a circle [m].

    D_M = d_b (tan(tan(alpha_y) + eta_b) - tan(alpha_y)). ``radius`` [m] is larger than the base radius,
    alpha_y is the profile angle at this radius, and eta_b is half the space at the base circle as an angle.
    """
    tangent = math.sqrt(radius**2 - tooth.base_radius**2) / tooth.base_radius
    return 2.0 * tooth.base_radius * (math.tan(tangent + _space_at_base(tooth)) - tangent)


def over_balls(tooth: ToothProfile, ball: float) -> float:
    """Return M_dK, the dimension over two balls in opposite or nearly opposite spaces [m].

    inv(alpha_K) = D_M / d_b - eta_b; M_dK = d_b / cos(alpha_K) + D_M with an even number of teeth, with an
    odd one d_b cos(pi / (2 z)) / cos(alpha_K) + D_M. ``ball`` is the diameter D_M [m], eta_b as for
    `ball_touching_at`.

    >>> tooth = ToothProfile(18, 21e-3, math.radians(20.0), 0.389, 1.25, 0.38)
    >>> round(1e3 * over_balls(tooth, 45e-3), 3)
    466.306
    """
    angle = inverse_involute(0.5 * ball / tooth.base_radius - _space_at_base(tooth))
    centres = 2.0 * tooth.base_radius / math.cos(angle)
    return centres * _across(tooth.teeth) + ball


def shift_from_balls(tooth: ToothProfile, ball: float, measured: float) -> float:
    """Return the profile shift coefficient of a gear with this dimension over balls [m].

    The inverse of `over_balls`; the ``profile_shift`` of ``tooth`` is not read.
    """
    centres = (measured - ball) / _across(tooth.teeth)
    half_space = 0.5 * ball / tooth.base_radius - involute(math.acos(2.0 * tooth.base_radius / centres))
    unshifted = _space_at_base(replace(tooth, profile_shift=0.0))
    return (unshifted - half_space) * tooth.teeth / (2.0 * math.tan(tooth.pressure_angle))


def _across(teeth: int) -> float:
    """Distance of two opposite balls over the diameter of the circle of the balls."""
    return 1.0 if teeth % 2 == 0 else math.cos(0.5 * math.pi / teeth)


def _space_at_base(tooth: ToothProfile) -> float:
    """Half the space between two teeth on the base circle, as an angle at the gear's centre [rad]."""
    return math.pi / tooth.teeth - tooth.base_half_angle


def as_made(tooth: ToothProfile, thinning: float) -> ToothProfile:
    """Return the tooth with its generating profile shift x_E.

    x_E = x - thinning / (2 m sin(alpha)). ``thinning`` of this gear along the line of action [m] shortens the
    span. The result is for measures of the flanks: the root of the model belongs to x.
    """
    less = thinning / (2.0 * tooth.module * math.sin(tooth.pressure_angle))
    return replace(tooth, profile_shift=tooth.profile_shift - less)


def _as(label: str, symbol: str, unit: str, decided_by: str = "") -> dict[str, str]:
    """Label, symbol and unit of a measure, and the field of the parameter file that decides the measure."""
    return {"label": label, "symbol": symbol, "unit": unit, "decided_by": decided_by}


@dataclass(frozen=True)
class GearMeasures:
    """The measures of one gear of a pair on a drawing, SI.

    Attributes
    ----------
    teeth : number of teeth z
    profile_shift : coefficient x [-]
    tip_alteration : k m, negative where the tooth is shortened [m]
    reference_diameter, base_diameter : d, d_b [m]
    tip_diameter, root_diameter : d_a, d_f [m]
    form_diameter : d_Ff, where the involute starts above the root fillet [m]
    operating_diameter : d_w, of the pitch circle at this centre distance [m]
    tooth_thickness : s, arc on the reference circle, of the tooth as made [m]
    tip_thickness : s_a, arc on the tip circle, of the tooth as made [m]
    tip_clearance : c, between the root circle and the mate's tip circle [m]
    teeth_spanned : k
    span : W_k over these teeth as made [m]; None: planes over them do not touch the involutes
    ball_diameter : D_M [m]
    over_balls : M_dK with these balls, of the teeth as made [m]
    """

    teeth: int = field(metadata=_as("number of teeth", "z", "", "teeth"))
    profile_shift: float = field(metadata=_as("profile shift coefficient", "x", "", "profile_shift"))
    tip_alteration: float = field(metadata=_as("tip alteration", "k m", "mm", "tip_alteration"))
    reference_diameter: float = field(metadata=_as("reference diameter", "d", "mm"))
    base_diameter: float = field(metadata=_as("base diameter", "d_b", "mm"))
    tip_diameter: float = field(metadata=_as("tip diameter", "d_a", "mm", "tip_alteration"))
    root_diameter: float = field(metadata=_as("root diameter", "d_f", "mm"))
    form_diameter: float = field(metadata=_as("root form diameter", "d_Ff", "mm"))
    operating_diameter: float = field(metadata=_as("operating pitch diameter", "d_w", "mm"))
    tooth_thickness: float = field(metadata=_as("tooth thickness on the reference circle", "s", "mm"))
    tip_thickness: float = field(metadata=_as("tooth thickness on the tip circle", "s_a", "mm"))
    tip_clearance: float = field(metadata=_as("clearance of its root", "c", "mm"))
    teeth_spanned: int = field(metadata=_as("number of teeth spanned", "k", ""))
    span: float | None = field(metadata=_as("span", "W_k", "mm"))
    ball_diameter: float = field(metadata=_as("ball diameter", "D_M", "mm"))
    over_balls: float = field(metadata=_as("dimension over two balls", "M_dK", "mm"))


@dataclass(frozen=True)
class TableRow:
    """One row of the table of a pair, in the units of a drawing.

    Attributes
    ----------
    label, symbol : of the quantity
    unit : "mm", "deg" or "" for a pure number
    values : of pinion and gear, or one value of the pair; a text where a measure does not exist
    decided_by : for each value the field of the parameter file that decides it, for ``pair.state``; empty
        where several fields do
    """

    label: str
    symbol: str
    unit: str
    values: tuple[float | int | str, ...]
    decided_by: tuple[str, ...] = ()

    def texts(self) -> tuple[str, ...]:
        """Return the values as text: lengths to 1 um, angles to 0.001 deg, coefficients to 0.0001."""
        digits = 4 if self.unit == "" else 3
        return tuple(f"{one:.{digits}f}" if isinstance(one, float) else str(one) for one in self.values)


@dataclass(frozen=True)
class GearTable:
    """The measures of a pair on two drawings and an assembly, SI.

    Attributes
    ----------
    module : m [m]
    pressure_angle : of the basic rack, alpha [rad]
    pinion, gear : measures of each drawing
    centre_distance : a [m]
    operating_pressure_angle : alpha_w [rad]
    normal_backlash : j_n along the line of action, of thinning and centre distance together [m]
    circumferential_backlash : j_t on the operating pitch circles [m]
    contact_ratio : epsilon_alpha [-]
    """

    module: float = field(metadata=_as("module", "m", "mm", "basic_rack.module"))
    pressure_angle: float = field(metadata=_as("pressure angle", "alpha", "deg", "basic_rack.pressure_angle"))
    pinion: GearMeasures
    gear: GearMeasures
    centre_distance: float = field(metadata=_as("centre distance", "a", "mm", "centre_distance"))
    operating_pressure_angle: float = field(metadata=_as("operating pressure angle", "alpha_w", "deg"))
    normal_backlash: float = field(metadata=_as("normal backlash", "j_n", "mm", "mesh.backlash"))
    circumferential_backlash: float = field(
        metadata=_as("circumferential backlash", "j_t", "mm", "mesh.backlash")
    )
    contact_ratio: float = field(metadata=_as("transverse contact ratio", "epsilon_alpha", ""))

    def rows(self) -> tuple[TableRow, ...]:
        """Return the rows of the table in the order of a drawing: basic rack, gears, assembly."""
        return tuple(self._rows())

    def _rows(self) -> Iterator[TableRow]:
        for one in fields(self):
            if one.name == "pinion":
                for of_gear in fields(self.pinion):
                    values = getattr(self.pinion, of_gear.name), getattr(self.gear, of_gear.name)
                    yield _shown(of_gear.metadata, values, ("pinion.", "gear."))
            elif one.name != "gear":
                yield _shown(one.metadata, (getattr(self, one.name),), ("",))

    def __str__(self) -> str:
        """Return the table as aligned text: quantity, symbol, unit, pinion and gear or the pair."""
        lines: list[tuple[str, ...]] = [("", "", "", "pinion", "gear")]
        lines += [(row.label, row.symbol, row.unit, *row.texts(), "")[:5] for row in self.rows()]
        widths = [max(len(line[column]) for line in lines) for column in range(5)]
        texts = (
            "  ".join(
                text.ljust(width) if column < 3 else text.rjust(width)
                for column, (text, width) in enumerate(zip(line, widths, strict=True))
            )
            for line in lines
        )
        return "\n".join(text.rstrip() for text in texts)


def _shown(about: Any, values: tuple[float | int | None, ...], sections: tuple[str, ...]) -> TableRow:
    """Row of a field with metadata. Values in SI are converted to the units of a drawing."""
    scale = {"mm": 1e3, "deg": math.degrees(1.0), "": 1}[about["unit"]]
    shown = tuple("not measurable" if one is None else one * scale for one in values)
    deciding = tuple(section + about["decided_by"] for section in sections) if about["decided_by"] else ()
    return TableRow(about["label"], about["symbol"], about["unit"], shown, deciding)


class _Thinned(Protocol):
    @property
    def backlash(self) -> float:
        """Normal thinning of both gears [m]."""


class CutPair(Protocol):
    """The attributes of a gear pair that the table reads."""

    @property
    def wheels(self) -> tuple[Wheel, Wheel]:
        """Pinion and gear as cut by the rack."""

    @property
    def geometry(self) -> Geometry:
        """Geometry of the pair at the centre distance."""

    @property
    def basic_rack(self) -> Any:
        """Basic rack with ``addendum_coefficient``."""

    @property
    def mesh(self) -> _Thinned:
        """Mesh with ``backlash``."""


def gear_table(
    pair: CutPair,
    teeth_spanned: tuple[int, int] | None = None,
    balls: tuple[float, float] | None = None,
) -> GearTable:
    """Return the diameters, thicknesses and inspection dimensions of a pair for drawings.

    Parameters
    ----------
    pair : a GearPair
    teeth_spanned : numbers of teeth k of the drawings; default those whose span touches the flanks nearest
        to the circle of diameter d + 2 x m
    balls : ball diameters D_M of the drawings [m]; default balls that touch there, rounded up to 0.25 mm
        (below 2.5 mm to 0.05 mm), and so large that they stand out of the tip circle

    Notes
    -----
    Each gear has half of ``pair.mesh.backlash``; thickness, span and dimension over balls are of teeth as
    made. With unequal thinning use `as_made` with `span` and `over_balls`.
    """
    g = pair.geometry
    first, second = pair.wheels
    thinning = 0.5 * pair.mesh.backlash
    addendum = pair.basic_rack.addendum_coefficient
    spans = teeth_spanned or (None, None)
    sizes = balls or (None, None)
    return GearTable(
        module=first.tooth.module,
        pressure_angle=first.tooth.pressure_angle,
        pinion=_measured(first, second, g, thinning, addendum, spans[0], sizes[0]),
        gear=_measured(second, first, g, thinning, addendum, spans[1], sizes[1]),
        centre_distance=g.centre_distance,
        operating_pressure_angle=g.operating_pressure_angle,
        normal_backlash=g.normal_backlash,
        circumferential_backlash=g.normal_backlash / math.cos(g.operating_pressure_angle),
        contact_ratio=g.contact_ratio,
    )


def _measured(
    wheel: Wheel,
    mate: Wheel,
    g: Geometry,
    thinning: float,
    addendum: float,
    number: int | None,
    ball: float | None,
) -> GearMeasures:
    tooth = wheel.tooth
    made = as_made(tooth, thinning)
    reference = tooth.reference_radius
    base = tooth.base_radius
    tip = wheel.tip_radius
    form = math.hypot(base, tooth.form_length)
    measured_at = _measuring_radius(tooth, form, tip)
    k = number or teeth_spanned(tooth, measured_at)
    width = span(made, k)
    touched = math.hypot(base, 0.5 * width)
    size = ball or _standing_out(made, ball_touching_at(tooth, measured_at), tip)
    tip_angle = made.base_half_angle - involute(math.acos(base / tip))
    return GearMeasures(
        teeth=tooth.teeth,
        profile_shift=tooth.profile_shift,
        tip_alteration=tip - reference - tooth.module * (addendum + tooth.profile_shift),
        reference_diameter=2.0 * reference,
        base_diameter=2.0 * base,
        tip_diameter=2.0 * tip,
        root_diameter=2.0 * tooth.root_radius,
        form_diameter=2.0 * form,
        operating_diameter=2.0 * base / math.cos(g.operating_pressure_angle),
        tooth_thickness=2.0 * reference * (made.base_half_angle - involute(tooth.pressure_angle)),
        tip_thickness=2.0 * tip * tip_angle,
        tip_clearance=g.centre_distance - tooth.root_radius - mate.tip_radius,
        teeth_spanned=k,
        span=width if form <= touched <= tip else None,
        ball_diameter=size,
        over_balls=over_balls(made, size),
    )


def _measuring_radius(tooth: ToothProfile, form: float, tip: float) -> float:
    """Radius on which flanks are measured: r + x m, or the middle of the involute if r + x m is outside."""
    shifted = tooth.reference_radius + tooth.profile_shift * tooth.module
    return shifted if form < shifted < tip else 0.5 * (form + tip)


#: Steps of ball diameters: for those from 2.5 mm on, and for smaller ones [m].
_COARSE = 0.25e-3
_FINE = 0.05e-3
_COARSE_FROM = 2.5e-3


def _standing_out(tooth: ToothProfile, ideal: float, tip: float) -> float:
    """Least diameter of the steps, from the ideal one on, with balls that stand out of the tip circle."""
    step = _COARSE if ideal >= _COARSE_FROM else _FINE
    size = step * math.ceil(ideal / step - 1e-9)
    while (over_balls(tooth, size) - size) / _across(tooth.teeth) + size <= 2.0 * tip:
        size += step
    return size
