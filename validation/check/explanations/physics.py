"""Alterations of our model that no field of a pair can say, and the motion of the altered model.

An alteration changes the records of the model: the element laws of a tooth pair, the constant data of the
equations of motion, and whether teeth may pull. The altered records run through the kernels of ``lumped``.

Sources: docs/how_to/check_your_model.md, "Explanations"; docs/theory/equations.md for the equations.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, NamedTuple

import numpy as np
import xarray as xr

from lumped.errors import NumericalError
from lumped.labelling import provenance
from lumped.mesh.damper import damping_coefficient
from lumped.mesh.records import Records
from lumped.model.equations import THETA_G, THETA_P, X_G, X_P, Y_G, Y_P, Structure, structure
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import LTVSystem, supports_of
from lumped.model.results import dataset
from lumped.model.revolution_motion import plain_motion
from lumped.model.steady import UNSTABLE, periodic_solution, sample_times
from lumped.model.tooth_laws import ToothLaws
from lumped.model.unilateral_motion import Shooting, motion_of_shooting
from lumped.path_function import PathFunction
from lumped.quasi_static.contacts import contact_of
from lumped.quasi_static.elements import MeshElements, mean_of_pairs
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.motion_curves import MotionCurves
from validation.check.reference import lumped_motion

#: Samples in a mesh cycle of an altered motion.
_SAMPLES = 512
#: A tooth pair pulls below this load over the static mesh force.
_PULLS = -1e-6
#: Altered equations whose linear motion grows by more than this factor in a mesh cycle have no motion.
_GROWS = 1.2
#: Fit error of an altered law over its largest value.
_TOLERANCE = 1e-7
#: Places in a mesh cycle at which a stiffness is smoothed, and the harmonics of a smoothed stiffness.
_COURSE = 2048
_HARMONICS = 30
#: Least stiffness of the whole mesh over its mean, where a change would make it negative.
_LEAST_STIFFNESS = 0.02
#: Positions closer than this share of the base pitch are one.
_SAME = 1e-9

Damper = Literal["of each pair", "of the whole mesh", "proportional", "constant"]
Stiffness = Literal[
    "",
    "reversed",
    "constant",
    "single pair",
    "double pair",
    "shared evenly",
    "whole mesh for each pair",
    "levels exchanged",
    "first harmonic",
    "three harmonics",
    "two levels",
]
Friction = Literal[
    "",
    "without reversal",
    "leading pair",
    "total load on the leading pair",
    "pitch point of the rack",
    "middle of the path",
]
Bearings = Literal["elastic", "rigid", "left out"]


@dataclass(frozen=True)
class Physics:
    """Alterations of the model. The defaults alter nothing.

    Attributes
    ----------
    pulling : whether teeth may pull: the linear motion
    friction : factor on the friction coefficient; negative: friction acts against its true sense
    moment_pinion, moment_gear : factors on the moments of friction about the axes
    force_pinion, force_gear : factors on the friction forces on the translations
    mesh_force_gear : factor on the mesh force along the line of action of the gear
    course : course of the friction over the path of contact
    radius : factor on the base radii as lever arms of the mesh force and in the transmission error
    damper : law of the dampers of the teeth
    stiffness : change of the stiffness of the tooth pairs over the mesh cycle
    variation : factor on the variation of the stiffness of the whole mesh about its mean
    smoothing : window of a moving average of the stiffness of the whole mesh [mesh cycles]
    error_cosine, error_sine : amplitudes of a profile error of all teeth at the mesh frequency, from A on [m]
    bearings : "rigid": without translations, bearings carry the mesh force; "left out": a torsional model
    """

    pulling: bool = False
    friction: float = 1.0
    moment_pinion: float = 1.0
    moment_gear: float = 1.0
    force_pinion: float = 1.0
    force_gear: float = 1.0
    mesh_force_gear: float = 1.0
    course: Friction = ""
    radius: float = 1.0
    damper: Damper = "of each pair"
    stiffness: Stiffness = ""
    variation: float = 1.0
    smoothing: float = 0.0
    error_cosine: float = 0.0
    error_sine: float = 0.0
    bearings: Bearings = "elastic"

    @property
    def of_stiffness(self) -> bool:
        """Whether the stiffness over the mesh cycle is altered."""
        return bool(self.stiffness) or self.variation != 1.0 or self.smoothing > 0.0

    @property
    def of_equations(self) -> bool:
        """Whether the constant data of the equations of motion are altered."""
        of_laws = {
            "pulling": False,
            "friction": 1.0,
            "course": "",
            "damper": "of each pair",
            "stiffness": "",
            "variation": 1.0,
            "smoothing": 0.0,
            "error_cosine": 0.0,
            "error_sine": 0.0,
        }
        return replace(self, **of_laws) != Physics()  # type: ignore[arg-type]


#: The model without alteration.
UNALTERED = Physics()


def motion_of(
    pair: GearPair, physics: Physics, recurrence: int | None, *, settles: bool = True
) -> MotionCurves:
    """Return the motion of a pair with alterations of the model.

    Parameters
    ----------
    pair : the gear pair
    physics : alterations of the model
    recurrence : as of ``lumped_motion``
    settles : whether a run settles where no stable motion is near the linear one; such a run takes seconds

    Raises
    ------
    NumericalError : the altered model has no stable periodic motion, or the pair refuses the alteration
    ParameterError : a law refuses the pair
    """
    prescribed = pair.mesh.contact == "prescribed"
    if pair.healthy is not pair and physics == UNALTERED:
        return lumped_motion(pair, recurrence)
    if pair.healthy is not pair or (physics.of_equations and pair.shafts is not None):
        raise NumericalError("This alteration needs like teeth; of the equations of motion, springs too.")
    if (physics.error_cosine or physics.error_sine) and not prescribed:
        raise NumericalError("A profile error at the mesh frequency needs prescribed contact.")
    if physics.of_stiffness and not prescribed:
        raise NumericalError("A stiffness over the mesh cycle needs prescribed contact.")
    again = recurrence or pair.pinion.teeth
    system = altered_system(pair, physics)
    if physics.pulling or prescribed:
        linear = _linear_motion(system, physics)
        if linear is not None:
            return MotionCurves(pair, linear, 1, again)
    if physics.pulling:
        raise NumericalError("The linear motion is unstable.")
    if physics.of_equations:
        start = periodic_solution(system, np.zeros(1), estimate_error=False)
        if start.spectral_radius > _GROWS:
            raise NumericalError("The motion of the altered equations grows without bound.")
    shooting = Shooting.of_laws(pair, system, AlteredLaws(pair, physics), _SAMPLES)
    motion = motion_of_shooting(shooting, settles=settles)
    if motion.spectral_radius > UNSTABLE:
        raise NumericalError("The periodic motion is unstable.")
    origin = partial(provenance, pair, samples_per_cycle=_SAMPLES, contact="unilateral")
    labelled = plain_motion(motion, origin).dataset
    return MotionCurves(pair, _with_bearing_forces(labelled, physics, system), motion.period, again)


def altered_system(pair: GearPair, physics: Physics) -> LTVSystem:
    """Return the "full" system of a pair with alterations of the model."""
    cycle = MeshCycle(pair.geometry, altered_elements(pair, physics))
    equations = altered_equations(structure(pair), physics) if physics.of_equations else None
    supports = supports_of(pair, None)
    return LTVSystem.of(pair, "full", cycle=cycle, supports=supports, equations=equations)


def altered_equations(s: Structure, physics: Physics) -> Structure:
    """Return the constant data of the equations of motion with the factors of the alterations."""
    normal = s.normal.copy()
    deflection = s.deflection.copy()
    arm = s.friction_arm.copy()
    rotations = [THETA_P, THETA_G]
    translations = [X_P, X_G, Y_P, Y_G]
    normal[rotations] *= physics.radius
    deflection[rotations] *= physics.radius
    normal[X_G] *= physics.mesh_force_gear
    arm[THETA_P] *= physics.moment_pinion
    arm[THETA_G] *= physics.moment_gear
    arm[Y_P] *= physics.force_pinion
    arm[Y_G] *= physics.force_gear
    apart = s.apart.copy()
    if physics.bearings != "elastic":
        for forces in (normal, deflection, arm, apart):
            forces[translations] = 0.0
    return replace(s, normal=normal, deflection=deflection, friction_arm=arm, apart=apart)


def altered_elements(pair: GearPair, physics: Physics) -> MeshElements:
    """Return the element laws of a tooth pair with alterations of stiffness, dampers and friction."""
    elements = contact_of(pair).elements(pair)
    if physics.stiffness:
        elements = _with_stiffness(pair, elements, physics.stiffness)
    if physics.variation != 1.0:
        elements = _with_variation(pair, elements, physics.variation)
    if physics.smoothing > 0.0:
        elements = _with_smoothing(pair, elements, physics.smoothing)
    if physics.error_cosine or physics.error_sine:
        elements = _with_error(pair, elements, physics)
    if physics.damper != "of each pair":
        factor = damper_factor(pair, elements, physics.damper)
        damping = _fitted(lambda xi: elements.damping(xi) * factor(xi), pair, elements)
        elements = replace(elements, damping=damping)
    friction = altered_friction(pair, elements.friction, elements.stiffness, physics)
    return replace(elements, friction=friction)


def altered_friction(
    pair: GearPair, friction: PathFunction, stiffness: PathFunction, physics: Physics
) -> PathFunction:
    """Return the friction coefficient over xi with alterations of its size and of its course."""
    if physics.course:
        friction = _friction_over_path(pair, friction, stiffness, physics.course)
    return friction if physics.friction == 1.0 else friction.scaled(physics.friction)


def _friction_over_path(
    pair: GearPair, friction: PathFunction, stiffness: PathFunction, course: Friction
) -> PathFunction:
    """Friction coefficient over xi with another course.

    Without reversal: |mu|. Only the leading pair, the last one that is on the path of contact: mu where the
    next pair is no longer there, else 0. Its friction by the load of all pairs: mu K/k there, with the
    stiffness K of the whole mesh, because loads are shared as stiffnesses. Reversal at another place: |mu|
    with the sign that mu has on its side of that place.
    """
    low, high = friction.interval
    pitch = pair.geometry.base_pitch
    leads = high - pitch
    total = _total(pair, stiffness)
    reversal = reversal_of(pair, course, low, high)
    behind = float(np.sign(friction(np.array([high - _SAME * pitch]))[0]))

    def changed(xi: FloatArray) -> FloatArray:
        if course == "without reversal":
            return np.abs(friction(xi))
        if reversal is not None:
            return np.asarray(behind * np.sign(xi - reversal) * np.abs(friction(xi)))
        leading = np.where(xi > leads, friction(xi), 0.0)
        if course == "leading pair":
            return np.asarray(leading)
        of_pair = np.maximum(stiffness(xi), 1e-6 * pair_stiffness_scale)
        return np.asarray(leading * np.maximum(total(xi), of_pair) / of_pair)

    pair_stiffness_scale = mean_of_pairs(stiffness, pitch)
    laws = (friction, stiffness) if course.startswith("total") else (friction,)
    marks = _marks(pair, laws, low, high)
    marks = np.append(marks, [leads, pair.geometry.L_XP, *([] if reversal is None else [reversal])])
    marks = np.unique(marks[(marks > low + _SAME * pitch) & (marks < high - _SAME * pitch)])
    marks = marks[np.diff(marks, prepend=-np.inf) > _SAME * pitch]
    size = float(np.abs(changed(np.linspace(low, high, 401)[1:-1])).max())
    breaks = np.concatenate([[low], marks, [high]])
    return PathFunction.fit(changed, breaks, marks, tolerance=_TOLERANCE * max(size, 1e-300))


def reversal_of(pair: GearPair, course: Friction, low: float, high: float) -> float | None:
    """Return the place xi [m] at which friction reverses where that is not the pitch point; None: it is.

    The pitch point of the rack lies at r_b tan(alpha) with the pressure angle of the rack, not of operation.
    """
    if course == "pitch point of the rack":
        return pair.geometry.base_radius_pinion * math.tan(pair.basic_rack.pressure_angle)
    return 0.5 * (low + high) if course == "middle of the path" else None


class AlteredLaws(ToothLaws):
    """Laws of tooth pairs with alterations, for motions with unilateral contact."""

    def __init__(self, pair: GearPair, physics: Physics) -> None:
        super().__init__(pair)
        laws = contact_of(pair).elements(pair)
        self.friction = altered_friction(pair, self.friction, laws.stiffness, physics)
        self.factor: Callable[[FloatArray], FloatArray] | None = None
        if self.elements is not None:
            self.elements = altered_elements(pair, physics)
        elif physics.damper != "of each pair":
            self.factor = damper_factor(pair, laws, physics.damper)

    def of_kind(self, kind: int, xi: FloatArray) -> Records:
        """Return LAWS of a kind at positions xi of any shape [m]."""
        laws = super().of_kind(kind, xi)
        if self.factor is not None:
            laws["damping"] *= self.factor(xi)
        return laws


def damper_factor(pair: GearPair, elements: MeshElements, law: Damper) -> Callable[[FloatArray], FloatArray]:
    """Return the factor over xi from the damper of each pair, 2 zeta sqrt(k_i m_e), to another law.

    With K the sum of k_i over all pairs, each pair takes its part k_i/K of the damper of the mesh:
    2 zeta sqrt(K m_e), proportional 2 zeta K sqrt(m_e/mean K), constant 2 zeta sqrt(mean K m_e).
    """
    total = _total(pair, elements.stiffness)
    mean = mean_of_pairs(elements.stiffness, pair.geometry.base_pitch)
    mass = bodies_of(pair).effective_mass

    def factor(xi: FloatArray) -> FloatArray:
        whole = np.maximum(total(xi), 1e-6 * mean)
        stiffness = np.maximum(elements.stiffness(xi), 1e-6 * mean)
        under_root = {"of the whole mesh": whole, "proportional": whole**2 / mean}.get(law, mean)
        of_mesh = damping_coefficient(1.0, np.asarray(under_root + 0.0 * whole), mass)
        of_pair = damping_coefficient(1.0, stiffness, mass)
        return np.asarray(of_mesh * stiffness / whole / of_pair, dtype=np.float64)

    return factor


def _total(pair: GearPair, law: PathFunction, extra: float = 0.0) -> Callable[[FloatArray], FloatArray]:
    """Return the sum of a law over all pairs, as a function of the position xi of one of them."""
    low, high = law.interval
    pitch = pair.geometry.base_pitch
    reach = int(np.ceil((high - low + extra) / pitch))
    shifts = np.arange(-reach, reach + 1) * pitch
    return lambda xi: np.asarray(law(np.add.outer(xi, shifts)).sum(axis=-1), dtype=np.float64)


def _marks(pair: GearPair, laws: tuple[PathFunction, ...], low: float, high: float) -> FloatArray:
    """Positions strictly between low and high at which this pair, or another one, passes a break of a law."""
    pitch = pair.geometry.base_pitch
    reach = int(np.ceil((high - low) / pitch)) + 1
    places = np.concatenate([law.breaks for law in laws] + [[low, high]])
    copies = np.sort(np.add.outer(places, np.arange(-reach, reach + 1) * pitch).ravel())
    copies = copies[(copies > low + _SAME * pitch) & (copies < high - _SAME * pitch)]
    return np.asarray(copies[np.diff(copies, prepend=-np.inf) > _SAME * pitch], dtype=np.float64)


def _fitted(
    function: Callable[[FloatArray], FloatArray],
    pair: GearPair,
    elements: MeshElements,
    interval: tuple[float, float] | None = None,
) -> PathFunction:
    """Fit a law over xi that depends on the pair and its neighbours."""
    low, high = elements.stiffness.interval if interval is None else interval
    marks = _marks(pair, (elements.stiffness,), low, high)
    size = float(np.abs(function(np.linspace(low, high, 401)[1:-1])).max())
    breaks = np.concatenate([[low], marks, [high]])
    return PathFunction.fit(function, breaks, marks, tolerance=_TOLERANCE * max(size, 1e-300))


def _with_stiffness(pair: GearPair, elements: MeshElements, change: Stiffness) -> MeshElements:
    """Element laws with another stiffness over the mesh cycle; the dampers follow the new stiffness."""
    stiffness = elements.stiffness
    low, high = interval = stiffness.interval
    pitch = pair.geometry.base_pitch
    mean = mean_of_pairs(stiffness, pitch)
    total = _total(pair, stiffness)
    middle = 0.5 * (low + high)
    if change == "reversed":
        changed = _fitted(lambda xi: stiffness(low + high - xi), pair, elements)
    elif change == "constant":
        changed = _fitted(lambda xi: mean * stiffness(xi) / total(xi), pair, elements)
    elif change == "shared evenly":
        pairs = _total(pair, PathFunction.constant(1.0, low, high))
        changed = _fitted(lambda xi: total(xi) / np.maximum(pairs(xi), 1.0), pair, elements)
    elif change == "whole mesh for each pair":
        changed = _fitted(total, pair, elements)
    elif change == "levels exchanged":
        places = low + (np.arange(_COURSE) + 0.5) / _COURSE * pitch
        both = float(total(places).max() + total(places).min())
        changed = _fitted(lambda xi: stiffness(xi) * (both - total(xi)) / total(xi), pair, elements)
    elif change in ("first harmonic", "three harmonics", "two levels"):
        course = _smoother(pair, stiffness, change)
        changed = _fitted(lambda xi: stiffness(xi) * course(xi) / total(xi), pair, elements)
    else:
        count = 1.0 if change == "single pair" else 2.0
        one_pair = float(stiffness(np.array([middle]))[0])
        interval = (middle - 0.5 * count * pitch, middle + 0.5 * count * pitch)
        changed = PathFunction.constant(one_pair, *interval)
    return _with_law(pair, elements, changed, interval)


def _with_error(pair: GearPair, elements: MeshElements, physics: Physics) -> MeshElements:
    """Element laws with a further error of all teeth: cosine and sine at the mesh frequency, from A on."""
    g = pair.geometry
    low, high = elements.error.interval

    def error(xi: FloatArray) -> FloatArray:
        angle = 2.0 * np.pi * (xi - g.L_XA) / g.base_pitch
        wave = physics.error_cosine * np.cos(angle) + physics.error_sine * np.sin(angle)
        return np.asarray(elements.error(xi) + wave)

    breaks = np.concatenate([[low], _marks(pair, (elements.error,), low, high), [high]])
    size = float(np.abs(error(np.linspace(low, high, 401)[1:-1])).max())
    fitted = PathFunction.fit(error, breaks, breaks[1:-1], tolerance=_TOLERANCE * max(size, 1e-300))
    return replace(elements, error=fitted)


def _with_variation(pair: GearPair, elements: MeshElements, factor: float) -> MeshElements:
    """Element laws with another variation of the stiffness K of the whole mesh: k (mean + f (K - mean))/K."""
    stiffness = elements.stiffness
    mean = mean_of_pairs(stiffness, pair.geometry.base_pitch)
    total = _total(pair, stiffness)

    def changed(xi: FloatArray) -> FloatArray:
        whole = total(xi)
        varied = np.maximum(mean + factor * (whole - mean), _LEAST_STIFFNESS * mean)
        return np.asarray(stiffness(xi) * varied / whole)

    return _with_law(pair, elements, _fitted(changed, pair, elements), stiffness.interval)


def _with_law(
    pair: GearPair, elements: MeshElements, changed: PathFunction, interval: tuple[float, float]
) -> MeshElements:
    """Element laws with another stiffness of the tooth pair, which the dampers follow, on an interval."""
    stiffness = elements.stiffness
    mass = bodies_of(pair).effective_mass
    ratio = pair.mesh.damping_ratio

    def damping(xi: FloatArray) -> FloatArray:
        return np.asarray(damping_coefficient(ratio, np.maximum(changed(xi), 0.0), mass), dtype=np.float64)

    return replace(
        elements,
        stiffness=changed,
        damping=_fitted(damping, pair, elements, interval) if ratio else changed.scaled(0.0),
        error=PathFunction.constant(0.0, *interval) if interval != stiffness.interval else elements.error,
    )


def _smoother(
    pair: GearPair, stiffness: PathFunction, change: Stiffness
) -> Callable[[FloatArray], FloatArray]:
    """Return the stiffness of the whole mesh over xi, with less detail than it has.

    Its mean with one harmonic or three, or one value for each number of tooth pairs in contact.
    """
    low, high = stiffness.interval
    course = _course_of(pair, stiffness)
    places, values = course.places, course.values
    if change == "two levels":
        pairs = _total(pair, PathFunction.constant(1.0, low, high))
        count = np.round(pairs(places))
        levels = {float(number): float(values[count == number].mean()) for number in np.unique(count)}
        numbers, means = np.array(sorted(levels)), np.array([levels[one] for one in sorted(levels)])
        return lambda xi: np.asarray(np.interp(np.round(pairs(xi)), numbers, means), dtype=np.float64)
    return _of_harmonics(course, np.ones(1 if change == "first harmonic" else 3))


class _Course(NamedTuple):
    """The stiffness of the whole mesh [N/m] at equal steps of a base pitch.

    Attributes
    ----------
    places : (n,) positions xi [m]
    values : (n,) stiffness
    pitch : base pitch [m]
    """

    places: FloatArray
    values: FloatArray
    pitch: float


def _course_of(pair: GearPair, stiffness: PathFunction) -> _Course:
    """The stiffness of the whole mesh over a base pitch."""
    pitch = pair.geometry.base_pitch
    places = stiffness.interval[0] + (np.arange(_COURSE) + 0.5) / _COURSE * pitch
    return _Course(places, _total(pair, stiffness)(places), pitch)


def _of_harmonics(course: _Course, gains: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """The mean of a stiffness and its first harmonics times gains (m,), never below a least stiffness."""
    orders = np.arange(1, gains.size + 1)
    waves = np.fft.rfft(course.values)[1 : gains.size + 1] * (2.0 / _COURSE) * gains
    mean = float(course.values.mean())

    def stiffness(xi: FloatArray) -> FloatArray:
        angle = 2.0 * np.pi * np.multiply.outer((xi - course.places[0]) / course.pitch, orders)
        return np.asarray(np.maximum(mean + (np.exp(1j * angle) @ waves).real, _LEAST_STIFFNESS * mean))

    return stiffness


def _with_smoothing(pair: GearPair, elements: MeshElements, window: float) -> MeshElements:
    """Element laws whose stiffness of the whole mesh is averaged over a window [mesh cycles]."""
    stiffness = elements.stiffness
    total = _total(pair, stiffness)
    orders = np.arange(1, _HARMONICS + 1)
    smooth = _of_harmonics(_course_of(pair, stiffness), np.sinc(window * orders))
    changed = _fitted(lambda xi: stiffness(xi) * smooth(xi) / total(xi), pair, elements)
    return _with_law(pair, elements, changed, stiffness.interval)


def _linear_motion(system: LTVSystem, physics: Physics) -> xr.Dataset | None:
    """The linear motion. None: the motion is unstable, or teeth pull and must not."""
    times = sample_times(system.period, _SAMPLES)
    solution = periodic_solution(system, times, estimate_error=False)
    if solution.spectral_radius > UNSTABLE:
        return None
    torques = {"pinion_torque": solution.pinion_torque, "brake_torque": solution.brake_torque}
    motion = dataset(system, times, solution.states, provenance(system.pair) | torques)
    if not physics.pulling:
        force = system.pinion_torque / system.pair.geometry.base_radius_pinion
        if float(motion["normal_load"].min()) < _PULLS * force:
            return None
    return _with_bearing_forces(motion, physics, system)


def _with_bearing_forces(motion: xr.Dataset, physics: Physics, system: LTVSystem) -> xr.Dataset:
    """The motion of a model without translations, with the forces that its bearings carry.

    Rigid bearings carry the forces of the mesh on their gear. A torsional model has no bearing forces.
    """
    if physics.bearings == "elastic":
        return motion
    load = motion["normal_load"].to_numpy().sum(axis=0)
    friction = motion["friction_force"].to_numpy().sum(axis=0)
    true = structure(system.pair)
    rigid = 1.0 if physics.bearings == "rigid" else 0.0
    motion = motion.copy()
    for name, place in (("x_p", X_P), ("x_g", X_G), ("y_p", Y_P), ("y_g", Y_G)):
        force = -rigid * (true.normal[place] * load + true.friction_arm[place, 0] * friction)
        variable = f"bearing_force_{name}"
        motion[variable] = motion[variable].copy(data=force)
    return motion
