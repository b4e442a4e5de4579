"""The closed form of a gear pair with one degree of freedom: its coefficients between the switches.

Friction is proportional to the load of the motion (Airy's equation), or to a mean load (Meissner's equation).

Sources: docs/theory/floquet.md, "One degree of freedom"; M. Vaishya and R. Singh, J. Sound Vib. 243 (2001)
525-545.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from floquet.one_degree.linear_segments import LinearSegments
from lumped.errors import refuse
from lumped.model.mesh_cycle import PairState
from lumped.model.periodic_system import LTVSystem
from lumped.path_function import PathFunction
from lumped.typing import FloatArray

#: Load that friction is proportional to.
FrictionLoad = Literal["dynamic", "mean"]
#: Share by which a constant law varies by rounding: a fit errs by 2.5e-13 of its largest value.
_CONSTANT = 1e-11
#: Places inside a piece at which a law is compared, as shares of the piece.
_LOOKS = np.linspace(0.03, 0.97, 9)
#: Panels of a segment and Gauss-Legendre nodes of a panel for means of the motion.
_PANELS = 32
_NODES = 8


def friction_arm(equations: LTVSystem, position: FloatArray) -> FloatArray:
    """Share of a friction force that acts on delta [-] at distances xi (...) from X [m], on rigid bearings.

    The friction moments of both gears make delta'' = - F (r_bp xi/J_p + r_bg (L - xi)/J_g), and the normal
    load N makes delta'' = - N/m: the share is a = m (r_bp xi/J_p + r_bg (L - xi)/J_g).
    """
    normal, constant, slope = equations.per_load @ equations.deflection
    return np.asarray((constant + slope * position) / normal)


def force_by_torques(equations: LTVSystem) -> FloatArray:
    """Constant force F on delta per unit T_p and per unit T_g, (2,) [1/m]."""
    m = equations.deflection.size
    normal = equations.per_load[0] @ equations.deflection
    torques = np.stack([equations.torque_pinion[m:], equations.torque_gear[m:]])
    return np.asarray(torques @ equations.deflection / -normal)


@dataclass(frozen=True)
class _Balance:
    """The torque that the file states: its mean over the mesh cycle is the mean of moments on one gear.

    Attributes
    ----------
    torque : [N m]
    radius : base radius of the gear, the arm of normal loads [m]
    tangent_point : 0 for the pinion, L_XY for the gear: |tangent_point - xi| is the arm of friction [m]
    """

    torque: float
    radius: float
    tangent_point: float

    @classmethod
    def of(cls, equations: LTVSystem) -> _Balance:
        """Of the pinion, or of the gear where the file states the brake torque."""
        g = equations.pair.geometry
        operating = equations.pair.operating
        if operating.brake_torque == "balanced":
            return cls(operating.pinion_torque, g.base_radius_pinion, 0.0)
        return cls(float(operating.brake_torque), g.base_radius_gear, g.L_XY)

    def friction_arm(self, position: FloatArray) -> FloatArray:
        """Arm of the friction forces on this gear at positions xi [m]."""
        return np.abs(self.tangent_point - position)


def closed_form(
    equations: LTVSystem, mass: float, friction_load: FrictionLoad, damper_friction: bool
) -> LinearSegments:
    """The equation of `SingleDegree.closed_form`, whose arguments these are."""
    _check_constant_laws(equations)
    rubs = equations.cycle.elements.friction.coefficients.any()
    damped = equations.cycle.elements.damping.coefficients.any()
    if friction_load == "dynamic" and damper_friction and rubs and damped:
        allowed = "False with friction and mesh damping: c(t) is constant between switches then"
        action = "Give damper_friction=False, or set mesh.damping_ratio = 0."
        raise refuse("damper_friction", damper_friction, allowed, action)
    edges = equations.cycle.edges
    segments = np.arange(edges.size - 1)
    start, end = (equations.cycle.sample(times, segments) for times in (edges[:-1], edges[1:]))
    factors = [_factor(equations, pairs, friction_load) for pairs in (start, end)]
    each = np.ones(segments.size)
    unit = LinearSegments(
        mass=mass,
        edges=edges,
        stiffness_start=(start.stiffness * factors[0]).sum(axis=0),
        stiffness_end=(end.stiffness * factors[1]).sum(axis=0),
        damping=start.damping.sum(axis=0),
        force_start=each,
        force_end=each,
    )
    if friction_load == "mean":
        return _with_mean_load(equations, unit, start, end)
    force = _Balance.of(equations).torque / _mean_moment(equations, unit)
    return replace(unit, force_start=force * each, force_end=force * each)


def _factor(equations: LTVSystem, pairs: PairState, friction_load: FrictionLoad) -> FloatArray:
    """Factor 1 + mu a of friction on the stiffness of each pair (pairs, k); 1 with a mean load."""
    if friction_load == "mean":
        return np.ones_like(pairs.stiffness)
    return 1.0 + pairs.friction * friction_arm(equations, pairs.position)


def _mean_moment(equations: LTVSystem, unit: LinearSegments) -> float:
    """Mean moment of loads and friction on the gear of `_Balance` in the motion by F = 1 N [m]."""
    balance = _Balance.of(equations)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    panels = np.concatenate([
        np.linspace(a, b, _PANELS + 1)[:-1] for a, b in zip(unit.edges[:-1], unit.edges[1:], strict=True)
    ] + [unit.edges[-1:]])  # fmt: skip
    half = 0.5 * np.diff(panels)
    times = (panels[:-1, None] + half[:, None] * (1.0 + nodes)).ravel()
    motion = unit.motion(times)
    pairs = equations.cycle.sample(times, unit.segment_of(times))
    elastic = pairs.stiffness * motion.dte
    load = elastic + pairs.damping * motion.dte_dot
    moment = balance.radius * load + balance.friction_arm(pairs.position) * pairs.friction * elastic
    return float((half[:, None] * weights).ravel() @ moment.sum(axis=0)) / unit.period


def _with_mean_load(
    equations: LTVSystem, unit: LinearSegments, start: PairState, end: PairState
) -> LinearSegments:
    """Friction of the constant load T/r_b as a force, and F of the balanced torques."""
    balance = _Balance.of(equations)
    load = balance.torque / balance.radius
    lengths = np.diff(unit.edges) / unit.period
    forces, moments = [], []
    for pairs in (start, end):
        friction = pairs.friction * load * pairs.stiffness / pairs.stiffness.sum(axis=0)
        forces.append((friction * friction_arm(equations, pairs.position)).sum(axis=0))
        moments.append((friction * balance.friction_arm(pairs.position)).sum(axis=0))
    # Both are linear in time on each segment: the mean of the ends is the mean of the segment.
    mean_force, mean_moment = (0.5 * float(lengths @ (a + b)) for a, b in (forces, moments))
    constant = (balance.torque - mean_moment) / balance.radius + mean_force
    return replace(unit, force_start=constant - forces[0], force_end=constant - forces[1])


def _check_constant_laws(equations: LTVSystem) -> None:
    """Refuse laws that are not constant between the switches, and teeth with errors."""
    elements = equations.cycle.elements
    mesh = equations.pair.mesh
    if not (_constant(elements.stiffness) and _constant(elements.damping)):
        action = 'Give single_degree(pair, stiffness="rectangular").'
        raise refuse(
            "mesh.stiffness", mesh.stiffness.model, "a constant stiffness of every tooth pair", action
        )
    if elements.error.coefficients.any():
        action = 'Give single_degree(pair, stiffness="rectangular").'
        raise refuse("mesh.relief", mesh.relief, "teeth without errors", action)
    if not _constant(elements.friction):
        law = equations.pair.friction.law
        raise refuse("friction.law", law, "a constant |mu|", 'Choose friction.law = "coulomb".')


def _constant(law: PathFunction) -> bool:
    """Whether a law is constant on each of its pieces, to the rounding of its fit."""
    places = law.breaks[:-1, None] + np.diff(law.breaks)[:, None] * _LOOKS
    values = law(places)
    return bool((np.ptp(values, axis=1) <= _CONSTANT * np.abs(values).max()).all())
