"""Does the load of the finite elements depend on where its singularity is taken off?"""

from __future__ import annotations

import math

import numpy as np

from lumped.elasticity.gear import meshed
from lumped.elasticity.load import FAR, NEAR
from lumped.elasticity.ring import compliances
from lumped.gear_geometry.tooth_profile import ToothProfile
from validation.verification.checks import Check, check

_TEETH, _SHIFT, _POISSON = 9, 0.5, 0.3
#: Length along the base tangent of the load, near the tip, whose land only the larger circle meets; elements
#: at the surface; radii of another cut-off [modules].
_LENGTH, _SIZE, _OTHER = 3.9, 0.2, (0.2, 0.6)


def elastic_load() -> Check:
    """Largest change of the deflection of a tooth and of the next one by the radii of the cut-off.

    The split of the displacement into half plane and rest is a choice, so the sum must not know it: each
    term that is left out, of the surface, of the cut-off or of the body's mean motion, is seen here.
    """
    profile = ToothProfile(_TEETH, 1.0, math.radians(20.0), _SHIFT, 1.25, 0.38)
    tip, bore = 0.5 * _TEETH + 1.0 + _SHIFT, profile.root_radius / 4.0
    mesh, place = meshed(profile, tip, bore, _SIZE), np.array([_LENGTH])
    one, other = (
        compliances(mesh, _POISSON, _TEETH, place, 1, "free", radii) for radii in ((NEAR, FAR), _OTHER)
    )
    return check("elastic_load", float(np.abs(one - other).max() / np.abs(one).max()))
