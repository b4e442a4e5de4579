"""What the lumped and the multibody model each work out from the drawing, side by side before any motion.

The cross-check compares motions; here the numbers that enter them are compared, for every friction law and
whatever this pair uses, so that a difference has a name.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from lumped import GearPair, bodies
from lumped.errors import ParameterError
from lumped.friction.registry import FRICTIONAL
from lumped.path_of_contact import friction_path_function
from lumped.quasi_static.contacts import mesh_elements
from lumped.quasi_static.tooth_error import relief_error
from lumped.typing import FloatArray
from multibody.contact import kernels as kn
from multibody.contact.machine import circles, machine, masses
from validation.verification.checks import Check, check, rows_check
from validation.verification.loaded_form import loaded_form
from validation.verification.on_shafts import on_shafts

_PLACES = 101


def written_twice(pair: GearPair) -> tuple[Check, ...]:
    """Geometry, bodies, damping, relief, every friction law, static mesh and shafts, from both models.

    Parameters
    ----------
    pair : a validated gear pair
    """
    return (
        _geometry(pair),
        _bodies(pair),
        *_damping(pair),
        _laws(pair),
        *_relief(pair),
        *loaded_form(pair),
        *on_shafts(pair),
    )


def _geometry(pair: GearPair) -> Check:
    g, c = pair.geometry, circles(pair)
    both = c.base_pinion + c.base_gear
    omega = pair.operating.pinion_speed
    start, end = c.tangent - c.reach_gear, c.reach_pinion
    rows = [
        (g.base_radius_pinion, c.base_pinion),
        (g.base_radius_gear, c.base_gear),
        (g.tip_radius_pinion, c.tip_pinion),
        (g.tip_radius_gear, c.tip_gear),
        (g.base_pitch, c.pitch),
        (g.centre_distance, c.centre_distance),
        (g.L_XY, c.tangent),
        (g.L_XA, start),
        (g.L_XB, end - c.pitch),
        (g.L_XP, c.tangent * c.base_pinion / both),
        (g.L_XC, start + c.pitch),
        (g.L_XD, end),
        (g.contact_ratio, (end - start) / c.pitch),
        (g.pairs, math.floor((end - start) / c.pitch) + 1),
        (g.omega_gear, omega * pair.pinion.teeth / pair.gear.teeth),
        (g.mesh_period, 2.0 * math.pi / (omega * pair.pinion.teeth)),
        (g.face_width, min(pair.pinion.face_width, pair.gear.face_width)),
    ]
    return rows_check("geometry", rows)


def _bodies(pair: GearPair) -> Check:
    b, (mass, inertia) = bodies(pair), masses(pair)
    c = circles(pair)
    own = 1.0 / (c.base_pinion**2 / inertia[0] + c.base_gear**2 / inertia[1])
    found = [b.mass_pinion, b.mass_gear, b.inertia_pinion, b.inertia_gear, b.effective_mass]
    return rows_check("bodies", list(zip(found, [*mass, *inertia, own], strict=True)))


def _inside(pair: GearPair) -> FloatArray:
    g = pair.geometry
    return np.linspace(g.L_XA, g.L_XD, _PLACES + 2)[1:-1]


def _damping(pair: GearPair) -> Iterator[Check]:
    """Of prescribed contact; that of loaded contact belongs to its static mesh."""
    if pair.mesh.contact == "loaded":
        return
    elements, xi, p = mesh_elements(pair), _inside(pair), machine(pair).parameters
    own = p[kn.DAMPING] * np.sqrt(np.maximum(elements.stiffness(xi), 0.0))
    scale = max(float(np.abs(own).max()), 1e-300)
    found = elements.damping(xi)
    yield rows_check("mesh_damping", np.stack([found, own], axis=1) / scale + 1.0)


def _laws(pair: GearPair) -> Check:
    """Largest difference of a friction coefficient, over its largest value."""
    worst, xi = 0.0, _inside(pair)
    for name in FRICTIONAL:
        try:
            law = friction_path_function(pair, name)
            p = machine(pair.with_(friction__law=name)).parameters
        except ParameterError:  # a law that this pair does not allow
            continue
        own = np.array([kn.nominal_friction(p, x) for x in xi])
        away = np.abs(law(xi) - own)
        # Where a law jumps, rounding of the place decides; such a place is left out.
        away[np.abs(xi[:, None] - np.append(law.switches, 0.0)).min(axis=1) < 1e-9] = 0.0
        worst = max(worst, float(away.max() / max(np.abs(own).max(), 1e-300)))
    return check("friction_laws", worst)


def _relief(pair: GearPair) -> Iterator[Check]:
    reliefs = [r for gear in (pair.pinion, pair.gear) for r in (gear.tip_relief, gear.root_relief) if r]
    if not reliefs:
        return
    xi, p = _inside(pair), machine(pair.with_({"mesh.relief": "static"})).parameters
    own = np.array([kn.relief_at(p, x)[0] for x in xi])
    scale = float(sum(r.amount for r in reliefs))
    yield rows_check("relief", np.stack([relief_error(pair, xi), own], axis=1) / scale + 1.0)
