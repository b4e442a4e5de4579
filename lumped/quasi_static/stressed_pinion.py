"""Stress and deflection of the pinion under the static loads of its teeth, by plane finite elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lumped.arguments import real_number
from lumped.elasticity.field import GearField, gear_field
from lumped.elasticity.gear import PlaneGear
from lumped.quasi_static.transmission_error import static_transmission_error
from lumped.schema.files import AnyPair, load_gear_pair


def stressed_pinion(pair: AnyPair, phase: float = 0.0) -> GearField:
    """Field of the free pinion in plane stress, at one position of the mesh cycle.

    Parameters
    ----------
    pair : a validated gear pair; its stiffness model and torque share the load
    phase : mesh cycles after a pair was at A, rounded to 1/256

    Returns
    -------
    GearField with lengths and displacements in m and stresses in Pa, the tooth that was at A upwards. A point
    load stands for each contact, so stresses within 0.15 modules of it are no result.

    Raises
    ------
    NumericalError : the teeth cannot be meshed
    """
    pair = load_gear_pair(pair)
    place = real_number("phase", phase, 0.0, 1.0, unit="mesh cycles")
    still = static_transmission_error(pair, phases=256).isel(torque=0, phase=round(256 * place) % 256)
    wheel, modulus = pair.wheels[0], pair.pinion.youngs_modulus
    module, width = wheel.tooth.module, wheel.face_width
    own = replace(wheel.tooth, module=1.0)
    radius = 0.5 * wheel.bore / module
    blank = PlaneGear(own, wheel.tip_radius / module, radius, pair.pinion.poisson_ratio, "free", 0)
    loads = {
        int(ahead): (float(at) / module, float(load))
        for ahead, at, load in zip(still["pair"], still["position"], still["normal_load"], strict=True)
        if load > 0.0
    }
    found = gear_field(blank, loads)
    up = np.array([[0.0, 1.0], [-1.0, 0.0]])  # rows (x, y) to (-y, x)
    x, y, shear = found.stress.T
    return replace(
        found,
        nodes=found.nodes @ up * module,
        moved=found.moved @ up / (modulus * width),
        stress=np.stack([y, x, -shear], axis=-1) / (module * width),
    )
