"""The gear bodies between teeth and shafts: their twist, and rims too thin for any stiffness model."""

from __future__ import annotations

from lumped.ranges import RangeViolation, range_violations
from lumped.stiffness.base import MeshingPair
from lumped.stiffness.foundation import BODY_RATIO, torsional_stiffness


def body_twist(pair: MeshingPair) -> tuple[float, float]:
    """Torsional stiffness of both gear bodies from root circle to bore [N m/rad]; infinite without a bore.

    The angles of the model are those of the rims. Between rim and shaft acts this spring, in series with the
    shaft: no part of the tooth stiffness, as all pairs share it. Over the square of the base radius it is a
    stiffness along the line of action.
    """
    pinion, gear = (
        wheel.face_width
        * torsional_stiffness(
            wheel.tooth.root_radius, 0.5 * wheel.bore, body.youngs_modulus, body.poisson_ratio
        )
        for wheel, body in zip(pair.wheels, (pair.pinion, pair.gear), strict=True)
    )
    return pinion, gear


def thin_rims(pair: MeshingPair) -> tuple[RangeViolation, ...]:
    """Bored gears whose rim is too thin for the stiffness of a solid body."""
    found: list[RangeViolation] = []
    for name, wheel in zip(("pinion", "gear"), pair.wheels, strict=True):
        if wheel.bore > 0.0:
            ratio = {BODY_RATIO.quantity: wheel.tooth.root_radius / (0.5 * wheel.bore)}
            found += range_violations(f"rim of the {name}", (BODY_RATIO,), ratio)
    return tuple(found)
