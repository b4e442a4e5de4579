"""Alterations of our model that no field of a pair can say, and the motion of the altered model.

An alteration changes the records of the model: the element laws of a tooth pair, the constant data of the
equations of motion, and whether teeth may pull. The altered records run through the kernels of ``lumped``.

Sources: docs/how_to/check_your_model.md, "Explanations"; docs/theory/equations.md for the equations.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np
import xarray as xr

from lumped.errors import NumericalError
from lumped.labelling import provenance
from lumped.mesh.records import Records
from lumped.model.equations import THETA_G, THETA_P, X_G, X_P, Y_G, Y_P, Structure, structure
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import LTVSystem, supports_of
from lumped.model.results import LOAD_NOISE, PlainMotion, plain_linear
from lumped.model.revolution_motion import plain_motion
from lumped.model.steady import UNSTABLE, PeriodicSolution, periodic_solution, sample_times
from lumped.model.tooth_laws import ToothLaws
from lumped.model.unilateral_motion import Shooting, motion_of_shooting
from lumped.path_function import PathFunction
from lumped.quasi_static.contacts import contact_of
from lumped.quasi_static.elements import MeshElements, mean_of_pairs
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.explanations.contact_laws import (
    Compliance,
    TableJoin,
    with_bearings_in_series,
    with_compliance,
    with_compliance_in_series,
    with_fewer_pairs,
    with_last_value_held,
    with_path,
    with_peak,
    with_table,
    with_table_of_pair,
    with_table_of_places,
)
from validation.check.explanations.contact_motion import OF_STATIC_LOAD, ContactForce, contact_motion
from validation.check.explanations.error_laws import CommonError, with_common_error, with_relief_signs
from validation.check.explanations.friction_courses import (
    STATIC_LOAD,
    EqualStaticFriction,
    Friction,
    StaticFriction,
    friction_over_path,
    shifted_friction,
    smoothed_friction,
    static_friction,
)
from validation.check.explanations.friction_inputs import FrictionInput, with_friction_input
from validation.check.explanations.pair_laws import (
    Damper,
    Excitation,
    Stiffness,
    damper_factor,
    fitted,
    static_error,
    wave_error,
    with_error,
    with_excitation,
    with_lag,
    with_late_force,
    with_ramps,
    with_shape,
    with_smoothing,
    with_stiffness,
    with_variation,
)
from validation.check.explanations.step_schemes import Scheme, Stepped, stepped
from validation.check.motion_curves import MotionCurves
from validation.check.reference import lumped_motion

#: Samples in a mesh cycle of an altered motion.
SAMPLES = 512
_SAMPLES_OF_CONTACT = 256
#: Altered equations whose linear motion grows by more than this factor in a mesh cycle have no motion.
_GROWS = 1.2

Bearings = Literal[
    "elastic",
    "rigid",
    "rigid pinion",
    "rigid gear",
    "rigid along",
    "rigid across",
    "left out",
]
#: Coordinates that supports hold: those of the translations.
_HELD: Mapping[Bearings, tuple[int, ...]] = {
    "rigid": (X_P, X_G, Y_P, Y_G),
    "left out": (X_P, X_G, Y_P, Y_G),
    "rigid pinion": (X_P, Y_P),
    "rigid gear": (X_G, Y_G),
    "rigid along": (X_P, X_G),
    "rigid across": (Y_P, Y_G),
}
Arms = Literal[
    "",
    "from A",
    "from A on the pinion",
    "from both ends",
    "from the pitch point",
    "of the other gear",
    "of the pinion",
    "of the gear",
    "at the pitch point",
    "pitch radii",
    "base radii",
    "line of the rack",
]


@dataclass(frozen=True)
class Physics:
    """Alterations of the model. The defaults alter nothing.

    Attributes
    ----------
    pulling : whether teeth may pull: the linear motion
    friction : factor on the friction coefficient; negative: friction acts against its true sense
    moment_pinion, moment_gear : factors on the moments of friction about the axes
    force_pinion, force_gear : factors on the friction forces on the translations
    mesh_force_gear, mesh_force_pinion : factors on the mesh force along the line of action of a gear
    approach_pinion, approach_gear : factors on the displacements of the gears in the approach of the teeth
    arms : lever arms of the friction moments
    mass_damping : dampers of all coordinates in proportion to their masses, as a damping ratio at the mesh
        frequency
    path_shift : base pitches by which the path of contact lies further along its line, for friction and its
        lever arms
    course : course of the friction over the path of contact
    friction_input : value that the friction law reads wrongly
    tanh, ramp : friction that is smoothed by a tanh or a ramp, over a share of the largest sliding velocity
    radius : factor on the base radii as lever arms of the mesh force and in the transmission error
    damper : law of the dampers of the teeth
    proportional_bearings : whether dampers of bearings are to their stiffness as that of the mesh to its mean
    path_start, path_end : base pitches by which the path of contact starts and ends further along its line
    table : entries of a table of the stiffness of the whole mesh over a mesh cycle; 0: no table
    table_join : how the entries of this table are joined
    table_of_friction : whether the friction coefficient is in this table too
    compliance : change of parts of the compliance of the energy method
    peak : share of half the path by which the peak of a parabola lies further along it
    stiffness : change of the stiffness of the tooth pairs over the mesh cycle
    slope, curvature : further slope and curvature of the stiffness of a tooth pair over its path
    ramps : share of its path over which a tooth pair takes up and gives up its stiffness
    lag : mesh cycles by which the stiffness of the whole mesh comes late
    variation : factor on the variation of the stiffness of the whole mesh about its mean
    smoothing : window of a moving average of the stiffness of the whole mesh [mesh cycles]
    error_cosine, error_sine : amplitudes of a profile error of all teeth at the mesh frequency, from A on [m]
    static_error : factor with which the static deflection of the mesh is an error of all teeth
    static_orders : mesh orders that this error has; 0: all with the mean, -1: all without it
    relief_pinion, relief_gear : factors on the relief of each gear in the error of the teeth
    common_error : one error for all tooth pairs in contact
    pair_table : entries of a table of the stiffness of a tooth pair in each base pitch from A on, joined by
        straight lines; negative: without stiffness at A, as outside of contact; 0: no table
    most_pairs : most tooth pairs that carry load, the newest; negative: the oldest; 0: all
    last_value_held : whether the stiffness stays as at D up to the next whole mesh cycle
    series : constant compliance in series with each pair, over that of the mean stiffness of a pair
    bearings_in_series : whether the mesh stiffness has the bearings in it
    excitation : a constant mesh stiffness that a transmission error excites
    late_force : mesh cycles by which the forces of the teeth come late
    contact : another contact force
    scheme, steps : scheme of an integrator, and its steps in a mesh cycle; empty: steps of no length
    bearings : "rigid" and the like: without these translations, bearings carry the mesh force; "left out": a
        torsional model
    """

    pulling: bool = False
    friction: float = 1.0
    moment_pinion: float = 1.0
    moment_gear: float = 1.0
    force_pinion: float = 1.0
    force_gear: float = 1.0
    mesh_force_gear: float = 1.0
    mesh_force_pinion: float = 1.0
    approach_pinion: float = 1.0
    approach_gear: float = 1.0
    arms: Arms = ""
    mass_damping: float = 0.0
    path_shift: float = 0.0
    course: Friction = ""
    friction_input: FrictionInput = ""
    tanh: float = 0.0
    ramp: float = 0.0
    radius: float = 1.0
    damper: Damper = "of each pair"
    proportional_bearings: bool = False
    path_start: float = 0.0
    path_end: float = 0.0
    table: int = 0
    table_join: TableJoin = "lines"
    table_of_friction: bool = False
    compliance: Compliance = ""
    peak: float = 0.0
    stiffness: Stiffness = ""
    slope: float = 0.0
    curvature: float = 0.0
    ramps: float = 0.0
    lag: float = 0.0
    variation: float = 1.0
    smoothing: float = 0.0
    error_cosine: float = 0.0
    error_sine: float = 0.0
    static_error: float = 0.0
    static_orders: int = 0
    relief_pinion: float = 1.0
    relief_gear: float = 1.0
    common_error: CommonError = ""
    pair_table: int = 0
    most_pairs: int = 0
    last_value_held: bool = False
    series: float = 0.0
    bearings_in_series: bool = False
    excitation: Excitation = ""
    late_force: float = 0.0
    contact: ContactForce = ""
    scheme: Scheme = ""
    steps: int = 0
    bearings: Bearings = "elastic"

    @property
    def of_stiffness(self) -> bool:
        """Whether the stiffness over the mesh cycle is altered."""
        return self._alters(_OF_STIFFNESS)

    @property
    def of_error(self) -> bool:
        """Whether the error of the teeth is altered."""
        return self._alters(_OF_ERROR)

    @property
    def of_equations(self) -> bool:
        """Whether the constant data of the equations of motion are altered."""
        return self._alters(_OF_EQUATIONS)

    def _alters(self, names: tuple[str, ...]) -> bool:
        return any(getattr(self, name) != getattr(UNALTERED, name) for name in names)


#: Fields that alter the stiffness of the teeth, their error, and the constant data of the equations.
_OF_STIFFNESS = (
    "stiffness",
    "slope",
    "curvature",
    "ramps",
    "lag",
    "variation",
    "smoothing",
    "path_start",
    "path_end",
    "table",
    "pair_table",
    "compliance",
    "peak",
    "most_pairs",
    "last_value_held",
    "series",
    "bearings_in_series",
    "excitation",
)
_OF_ERROR = ("error_cosine", "error_sine", "static_error", "relief_pinion", "relief_gear", "common_error")
_OF_EQUATIONS = (
    "moment_pinion",
    "moment_gear",
    "force_pinion",
    "force_gear",
    "mesh_force_gear",
    "mesh_force_pinion",
    "approach_pinion",
    "approach_gear",
    "arms",
    "mass_damping",
    "proportional_bearings",
    "path_shift",
    "radius",
    "bearings",
)
#: Courses of the friction that need a system of their own.
_SYSTEMS = dict(zip(STATIC_LOAD, (StaticFriction, EqualStaticFriction), strict=True))
#: The model without alteration.
UNALTERED = Physics()


def motion_of(
    pair: GearPair,
    physics: Physics,
    recurrence: int | None,
    *,
    settles: bool = True,
    samples: int = SAMPLES,
) -> MotionCurves:
    """Return the motion of a pair with alterations of the model.

    Parameters
    ----------
    pair : the gear pair
    physics : alterations of the model
    recurrence : as of ``lumped_motion``
    settles : whether a run settles where no stable motion is near the linear one; such a run takes seconds
    samples : samples in a mesh cycle; another contact force has fewer

    Raises
    ------
    NumericalError : the altered model has no stable periodic motion, or the pair refuses the alteration
    ParameterError : a law refuses the pair
    """
    prescribed = pair.mesh.contact == "prescribed"
    if pair.healthy is not pair and physics == UNALTERED:
        return lumped_motion(pair, recurrence, samples=samples)
    if pair.healthy is not pair or (physics.of_equations and pair.shafts is not None):
        raise NumericalError("This alteration needs like teeth; of the equations of motion, springs too.")
    if physics.of_error and not prescribed:
        raise NumericalError("A further error of all teeth needs prescribed contact.")
    if physics.of_stiffness and not prescribed:
        raise NumericalError("A stiffness over the mesh cycle needs prescribed contact.")
    if physics.contact and not (prescribed and pair.shafts is None and physics.bearings == "elastic"):
        raise NumericalError("Another contact force needs prescribed contact and springs.")
    again = recurrence or pair.pinion.teeth
    if physics.contact:
        return _contact_motion(pair, physics, physics.contact, again)
    system = altered_system(pair, physics)
    if physics.pulling or prescribed:
        linear = _linear_motion(system, physics, samples)
        if linear is not None:
            return MotionCurves(pair, linear, 1, again)
    if physics.pulling:
        raise NumericalError("The linear motion is unstable.")
    if physics.scheme:
        raise NumericalError("Long steps need prescribed contact that is not lost; they are stable.")
    if physics.late_force:
        raise NumericalError("Forces that come late make the motion unstable, or teeth part.")
    if physics.course in STATIC_LOAD:
        if not (prescribed and pair.shafts is None and physics.bearings == "elastic"):
            raise NumericalError("Friction by the static load needs prescribed contact and springs.")
        return _contact_motion(pair, physics, OF_STATIC_LOAD[STATIC_LOAD.index(physics.course)], again)
    if physics.of_equations:
        start = periodic_solution(system, np.zeros(1), estimate_error=False)
        if start.spectral_radius > _GROWS:
            raise NumericalError("The motion of the altered equations grows without bound.")
    shooting = Shooting.of_laws(pair, system, AlteredLaws(pair, physics), samples)
    motion = motion_of_shooting(shooting, settles=settles)
    if motion.spectral_radius > UNSTABLE:
        raise NumericalError("The periodic motion is unstable.")
    origin = partial(provenance, pair, samples_per_cycle=samples, contact="unilateral")
    plain = _with_bearing_forces(plain_motion(motion, origin), physics, system)
    return MotionCurves(pair, plain, motion.period, again)


def _contact_motion(pair: GearPair, physics: Physics, contact: ContactForce, again: int) -> MotionCurves:
    """The motion with another contact force, of laws that hold where teeth are apart in statics."""
    system = altered_system(pair, replace(physics, course=""), unilateral=True)
    return MotionCurves.of(
        pair, contact_motion(system, contact, provenance(pair), _SAMPLES_OF_CONTACT), 1, again
    )


def altered_system(pair: GearPair, physics: Physics, *, unilateral: bool = False) -> LTVSystem:
    """Return the "full" system of a pair with alterations of the model.

    ``unilateral``: with the stiffness also where a pair is apart under the static load.
    """
    cycle = MeshCycle(pair.geometry, altered_elements(pair, physics, unilateral=unilateral))
    equations = altered_equations(pair, physics) if physics.of_equations else None
    supports = supports_of(pair, None)
    kind = _SYSTEMS.get(physics.course, LTVSystem)
    return kind.of(pair, "full", cycle=cycle, supports=supports, equations=equations)


def altered_equations(pair: GearPair, physics: Physics) -> Structure:
    """Return the constant data of the equations of motion with the factors of the alterations."""
    s = structure(pair)
    normal = s.normal.copy()
    deflection = s.deflection.copy()
    arm = friction_arms(pair, physics.arms)
    arm[:, 0] += arm[:, 1] * physics.path_shift * pair.geometry.base_pitch
    rotations = [THETA_P, THETA_G]
    normal[rotations] *= physics.radius
    deflection[rotations] *= physics.radius
    deflection[X_P] *= physics.approach_pinion
    deflection[X_G] *= physics.approach_gear
    normal[X_G] *= physics.mesh_force_gear
    normal[X_P] *= physics.mesh_force_pinion
    arm[THETA_P] *= physics.moment_pinion
    arm[THETA_G] *= physics.moment_gear
    arm[Y_P] *= physics.force_pinion
    arm[Y_G] *= physics.force_gear
    apart = s.apart.copy()
    if physics.bearings != "elastic":
        for forces in (normal, deflection, arm, apart):
            forces[list(_HELD[physics.bearings])] = 0.0
    damping = s.damping
    if physics.proportional_bearings:
        damping = proportional_dampers(pair, at_frequency=physics.damper.endswith("frequency"))
    damping = damping + damping_of_masses(pair, physics.mass_damping)
    return replace(s, damping=damping, normal=normal, deflection=deflection, friction_arm=arm, apart=apart)


def friction_arms(pair: GearPair, arms: Arms) -> FloatArray:
    """Return generalised forces (6, 2) per unit friction force, a[:, 0] + a[:, 1] xi, with other lever arms.

    The true lever arms are X_p = xi on the pinion and X_g = L_XY - xi on the gear.
    """
    g = pair.geometry
    arm = structure(pair).friction_arm.copy()
    if arms in ("from A on the pinion", "from both ends"):
        arm[THETA_P] = g.L_XA, -1.0
        if arms == "from both ends":
            arm[THETA_G] = g.L_XD, -1.0
    elif arms == "from the pitch point":
        arm[[THETA_P, THETA_G]] = g.L_XP, -1.0
    elif arms == "line of the rack":
        length = g.base_radius_pinion + g.base_radius_gear
        arm[THETA_G, 0] = length * math.tan(pair.basic_rack.pressure_angle)
    elif arms == "base radii":
        arm[THETA_P] = -g.base_radius_pinion, 0.0
        arm[THETA_G] = g.base_radius_gear, 0.0
    elif arms == "from A":
        arm[THETA_P] = g.L_XA, -1.0
        arm[THETA_G] = g.L_XY + g.L_XA, -1.0
    elif arms == "of the other gear":
        arm[THETA_P] = -g.L_XY, 1.0
        arm[THETA_G] = 0.0, 1.0
    elif arms == "of the pinion":
        arm[THETA_G] = 0.0, 1.0
    elif arms == "of the gear":
        arm[THETA_P] = -g.L_XY, 1.0
    elif arms == "at the pitch point":
        arm[THETA_P] = -g.L_XP, 0.0
        arm[THETA_G] = g.L_XY - g.L_XP, 0.0
    elif arms == "pitch radii":
        cosine = math.cos(g.operating_pressure_angle)
        arm[THETA_P] = -g.base_radius_pinion / cosine, 0.0
        arm[THETA_G] = g.base_radius_gear / cosine, 0.0
    return arm


def proportional_dampers(pair: GearPair, *, at_frequency: bool = False) -> FloatArray:
    """Return dampers (6,) of the bearings in proportion to their stiffness, with the ratio of the mesh.

    c = k 2 zeta sqrt(m_e/mean K), as the mesh damper is to the mean stiffness of the mesh. ``at_frequency``:
    c = k 2 zeta/omega with the mesh frequency.
    """
    if at_frequency:
        time = pair.mesh.damping_ratio * pair.geometry.mesh_period / math.pi
        return np.asarray(time * structure(pair).stiffness)
    mean = mean_of_pairs(contact_of(pair).elements(pair).stiffness, pair.geometry.base_pitch)
    time = 2.0 * pair.mesh.damping_ratio * math.sqrt(bodies_of(pair).effective_mass / mean)
    return np.asarray(time * structure(pair).stiffness)


def damping_of_masses(pair: GearPair, ratio: float) -> FloatArray:
    """Return dampers (6,) in proportion to masses and inertias m: 2 ratio omega m at the mesh frequency."""
    frequency = 2.0 * math.pi / pair.geometry.mesh_period
    return np.asarray(2.0 * ratio * frequency * structure(pair).mass)


def altered_elements(pair: GearPair, physics: Physics, *, unilateral: bool = False) -> MeshElements:
    """Return the element laws of a tooth pair with alterations of stiffness, dampers and friction."""
    contact = contact_of(pair)
    elements = contact.unilateral_elements(pair) if unilateral else contact.elements(pair)
    if physics.compliance:
        elements = with_compliance(pair, elements, physics.compliance)
    if physics.peak:
        elements = with_peak(pair, elements, physics.peak)
    if physics.path_start or physics.path_end:
        elements = with_path(pair, elements, physics.path_start, physics.path_end)
    if physics.stiffness:
        elements = with_stiffness(pair, elements, physics.stiffness)
    if physics.slope or physics.curvature:
        elements = with_shape(pair, elements, physics.slope, physics.curvature)
    if physics.ramps:
        elements = with_ramps(pair, elements, physics.ramps)
    if physics.variation != 1.0:
        elements = with_variation(pair, elements, physics.variation)
    if physics.smoothing > 0.0:
        elements = with_smoothing(pair, elements, physics.smoothing)
    if physics.table and physics.table_of_friction:
        elements = with_table_of_places(pair, elements, physics.table, physics.table_join)
    elif physics.table:
        elements = with_table(pair, elements, physics.table, physics.table_join)
    if physics.pair_table:
        elements = with_table_of_pair(pair, elements, physics.pair_table)
    if physics.most_pairs:
        elements = with_fewer_pairs(pair, elements, physics.most_pairs)
    if physics.last_value_held:
        elements = with_last_value_held(pair, elements)
    if physics.series:
        elements = with_compliance_in_series(pair, elements, physics.series)
    if physics.bearings_in_series:
        elements = with_bearings_in_series(pair, elements)
    if physics.excitation:
        elements = with_excitation(pair, elements, physics.excitation)
    if physics.lag:
        elements = with_lag(pair, elements, physics.lag)
    if (physics.relief_pinion, physics.relief_gear) != (1.0, 1.0):
        elements = with_relief_signs(pair, elements, physics.relief_pinion, physics.relief_gear)
    if physics.common_error:
        elements = with_common_error(pair, elements, physics.common_error)
    if physics.error_cosine or physics.error_sine:
        elements = with_error(pair, elements, wave_error(pair, physics.error_cosine, physics.error_sine))
    if physics.static_error:
        deflection = static_error(pair, elements.stiffness, physics.static_error, physics.static_orders)
        elements = with_error(pair, elements, deflection)
    if physics.damper != "of each pair":
        factor = damper_factor(pair, elements, physics.damper)
        damping = fitted(lambda xi: elements.damping(xi) * factor(xi), pair, elements)
        elements = replace(elements, damping=damping)
    if physics.late_force:
        elements = with_late_force(pair, elements, physics.late_force)
    friction = altered_friction(pair, elements.friction, elements.stiffness, physics)
    return replace(elements, friction=friction)


def altered_friction(
    pair: GearPair, friction: PathFunction, stiffness: PathFunction, physics: Physics
) -> PathFunction:
    """Return the friction coefficient over xi with alterations of its size and of its course."""
    if physics.friction_input:
        friction = with_friction_input(pair, friction, physics.friction_input)
    if physics.path_shift:
        friction = shifted_friction(pair, friction, physics.path_shift * pair.geometry.base_pitch)
    if physics.course:
        friction = friction_over_path(pair, friction, stiffness, physics.course)
    if physics.tanh > 0.0:
        friction = smoothed_friction(pair, friction, physics.tanh, "tanh")
    if physics.ramp > 0.0:
        friction = smoothed_friction(pair, friction, physics.ramp, "ramp")
    return friction if physics.friction == 1.0 else friction.scaled(physics.friction)


class AlteredLaws(ToothLaws):
    """Laws of tooth pairs with alterations, for motions with unilateral contact."""

    def __init__(self, pair: GearPair, physics: Physics) -> None:
        super().__init__(pair)
        laws = contact_of(pair).elements(pair)
        self.factor: Callable[[FloatArray], FloatArray] | None = None
        if self.elements is not None:
            self.elements = altered_elements(pair, physics)
            self.friction = self.elements.friction
            return
        self.friction = altered_friction(pair, self.friction, laws.stiffness, physics)
        if physics.damper != "of each pair":
            self.factor = damper_factor(pair, laws, physics.damper)

    def of_kind(self, kind: int, xi: FloatArray) -> Records:
        """Return LAWS of a kind at positions xi of any shape [m]."""
        laws = super().of_kind(kind, xi)
        if self.factor is not None:
            laws["damping"] *= self.factor(xi)
        return laws


def _linear_motion(system: LTVSystem, physics: Physics, samples: int) -> PlainMotion | None:
    """The linear motion. None: the motion is unstable, or teeth pull and must not."""
    times = sample_times(system.period, samples)
    solution: Stepped | PeriodicSolution
    if physics.scheme:
        solution = stepped(system, physics.scheme, physics.steps, samples)
    else:
        solution = periodic_solution(system, times, estimate_error=False)
    if solution.spectral_radius > UNSTABLE:
        return None
    torques = {"pinion_torque": solution.pinion_torque, "brake_torque": solution.brake_torque}
    motion = plain_linear(system, times, solution.states, torques, partial(provenance, system.pair))
    force = system.pair.operating.pinion_torque / system.pair.geometry.base_radius_pinion
    if not physics.pulling and motion.values["normal_load"].min() < -LOAD_NOISE * force:
        return None
    if isinstance(system, StaticFriction):
        friction = static_friction(system, system.cycle.sample(times), equal=system.equal)
        motion = _with_values(motion, {"friction_force": friction})
    return _with_bearing_forces(motion, physics, system)


def _with_values(motion: PlainMotion, values: Mapping[str, FloatArray]) -> PlainMotion:
    """The motion with other values of some variables, in its dataset too."""

    def make_dataset() -> xr.Dataset:
        return motion.dataset.assign({name: motion.dataset[name].copy(data=values[name]) for name in values})

    return replace(motion, values={**motion.values, **values}, make_dataset=make_dataset)


def _with_bearing_forces(motion: PlainMotion, physics: Physics, system: LTVSystem) -> PlainMotion:
    """The motion of a model without translations, with the forces that its bearings carry.

    Rigid bearings carry the forces of the mesh on their gear. A torsional model has no bearing forces.
    """
    if physics.bearings == "elastic":
        return motion
    load = motion.values["normal_load"].sum(axis=0)
    friction = motion.values["friction_force"].sum(axis=0)
    true = structure(system.pair)
    rigid = 0.0 if physics.bearings == "left out" else 1.0
    forces = {}
    names = {X_P: "x_p", X_G: "x_g", Y_P: "y_p", Y_G: "y_g"}
    for place in _HELD[physics.bearings]:
        name = names[place]
        force = -rigid * (true.normal[place] * load + true.friction_arm[place, 0] * friction)
        forces[f"bearing_force_{name}"] = force
    return _with_values(motion, forces)
