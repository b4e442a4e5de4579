"""Whether two gears can mesh: the limits that their drawing must keep.

Sources: ISO 21771 for the circles and the backlash; interference, undercut and pointed teeth are elementary
(docs/theory/equations.md, "Frame").
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from lumped.errors import FieldProblem
from lumped.gear_geometry.geometry import Geometry, Wheel, theoretical_backlash
from lumped.gear_geometry.tooth_profile import tooth_half_angle

#: Teeth of rounded published data may overlap by this much of a module before the pair is refused.
_WEDGE_TOLERANCE = 1e-4
_THROUGH_TANGENT_POINT = (
    "The tip would pass the mate's tangent point (involute interference): lower it, or raise the mate's "
    "profile_shift."
)
_CUT_AWAY = (
    "The rack has cut the involute away there (undercut or fillet): raise the profile shift, "
    "lower the mate's tip diameter or take more teeth."
)
_POINTED = "The tooth is pointed below its tip circle: lower the tip diameter or the profile shift."
_WEDGE = "The teeth would wedge: raise the centre distance or mesh.backlash, or lower the profile shifts."


def existence_problems(pinion: Wheel, gear: Wheel, g: Geometry, backlash: float) -> list[FieldProblem]:
    """Return the reasons why a pair cannot exist, each with the field of the schema to change.

    ``backlash`` is how much the teeth are thinner than the rack leaves them [m].
    """
    problems = list(_of_the_pair(g))
    # Distance from the tangent point on the own base circle to the last and to the first contact.
    last, first = g.L_XD, g.L_XA
    for name, wheel, tip, start in (
        ("gear", gear, g.L_XY - first, g.L_XY - last),
        ("pinion", pinion, last, first),
    ):
        problems += _of_one_gear(name, wheel, tip, start, g)
    play = theoretical_backlash(pinion, gear, g.operating_pressure_angle) + backlash
    if play < -_WEDGE_TOLERANCE * pinion.tooth.module:
        value = f"{g.centre_distance * 1e3:.6g} mm (backlash {play * 1e3:.4f} mm)"
        problems.append(FieldProblem("centre_distance", value, "normal backlash >= 0", _WEDGE))
    return problems


def _of_the_pair(g: Geometry) -> Iterator[FieldProblem]:
    if not math.isfinite(g.mesh_period):
        yield FieldProblem(
            "operating.pinion_speed",
            f"{g.omega_pinion:g} rad/s",
            "a mesh period in seconds that is a number",
            "Raise the speed.",
        )
    if not 1.0 <= g.contact_ratio <= 3.0:
        yield FieldProblem(
            "contact_ratio",
            f"{g.contact_ratio:.4f}",
            "1 to 3",
            "Change the tip diameters, centre distance, tooth numbers or pressure angle.",
        )


def _of_one_gear(name: str, wheel: Wheel, tip: float, start: float, g: Geometry) -> Iterator[FieldProblem]:
    """Problems of one gear whose flank is in contact from `start` to `tip` beyond its tangent point [m]."""
    tooth, base = wheel.tooth, wheel.tooth.base_radius
    diameter = 2e3 * wheel.tip_radius
    mate_root = g.root_radius_gear if name == "pinion" else g.root_radius_pinion
    own_root = g.root_radius_pinion if name == "pinion" else g.root_radius_gear

    def tip_problem(allowed: str, action: str) -> FieldProblem:
        return FieldProblem(f"{name}.tip_diameter", f"{diameter:.4f} mm", allowed, action)

    if tip > g.L_XY:
        yield tip_problem(f"<= {2e3 * math.hypot(base, g.L_XY):.4f} mm", _THROUGH_TANGENT_POINT)
    form = tooth.form_length
    if 0.0 <= start < form - 1e-9 * tooth.module:
        contact = (
            f"{tooth.profile_shift:g} with contact down to diameter {2e3 * math.hypot(base, start):.4f} mm"
        )
        allowed = f"contact above the form circle, diameter {2e3 * math.hypot(base, form):.4f} mm"
        yield FieldProblem(f"{name}.profile_shift", contact, allowed, _CUT_AWAY)
    if g.centre_distance - wheel.tip_radius - mate_root < 0.0:
        action = "The tip would hit the mate's root: lower it or raise the centre distance."
        yield tip_problem(f"<= {2e3 * (g.centre_distance - mate_root):.4f} mm", action)
    profile = math.acos(min(1.0, base / wheel.tip_radius))
    if tooth_half_angle(tooth.teeth, tooth.profile_shift, tooth.pressure_angle, profile) <= 0.0:
        yield tip_problem("tip thickness > 0", _POINTED)
    if wheel.bore >= 2.0 * own_root:
        yield FieldProblem(f"{name}.bore", f"{wheel.bore * 1e3:g} mm", "< root diameter", "Lower the bore.")
