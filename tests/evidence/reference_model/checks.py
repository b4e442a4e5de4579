"""The multibody model by means that do not come from its comparison with the lumped model, as numbers.

Free vibration: the mesh is frozen in the middle of the path, without friction and torque. Bodies too heavy
to move leave the rotation of the teeth on each other, a mesh without stiffness each body on its bearings.
Bodies: their outline has the multibody model's own flanks and tip circles, and the rack's trochoid as fillet.
Frozen modes: exudyn differentiates the forces of the assembled system. At fidelity "linear" that must be the
lumped A(t) of the same instant; at "exact" the line of action turns with the gear centres, and the total
normal load N acts as a spring -N/L_XY between y_p and y_g, which the lumped model has not.

Sources: the decrement of consecutive samples, R. de Prony 1795; Green's theorem on a polygon and Richardson's
extrapolation; docs/theory/multibody.md, "What is own and what is shared", "Two builds of one machine".
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import exudyn as exu
import numpy as np
from scipy.optimize import root

import lumped
from lumped.model.periodic_system import periodic_system
from lumped.schema.pair import GearPair
from lumped.typing import ComplexArray, FloatArray
from multibody.contact import friction as fr
from multibody.contact.elements import table_value
from multibody.contact.machine import Machine, machine, masses
from multibody.contact.records import opened, with_block
from multibody.gears.circles import base_tooth_angle, circles
from multibody.run.integration import Segment, integrate
from multibody.run.model import ExudynModel, accelerations, build, contact_state
from multibody.run.setup import Setup, prepare
from tests.evidence.check import Check, rows

PAIR = lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored")
#: Nothing alike: teeth, shifts, all damping ratios and bearings.
UNLIKE = lumped.load_gear_pair("fzg_c").with_(
    mesh__damping_ratio=0.07,
    mesh__stiffness={"model": "parabolic"},
    bearings__pinion={
        "loa_stiffness": 2e8, "oloa_stiffness": 5e7, "loa_damping_ratio": 0.02, "oloa_damping_ratio": 0.4,
    },
    bearings__gear={
        "loa_stiffness": 3e8, "oloa_stiffness": 1e8, "loa_damping_ratio": 1.2, "oloa_damping_ratio": 0.03,
    },
)  # fmt: skip


def reference_model() -> Iterator[Check]:
    """Damping by decay, bodies by their outline, frozen modes."""
    decays = [(decay.measured, decay.given) for decay in damping_check(UNLIKE)]
    yield rows("free vibration of mesh and bearings: decay", "damping ratios of the schema", 1e-6, decays)
    bodies = [blank for name in lumped.preset_names() for blank in blanks(lumped.load_gear_pair(name))]
    exact = "that of the disc that stands for the gear"
    mass, inertia = (
        [(getattr(b, f"taken_{what}"), getattr(b, what)) for b in bodies] for what in ("mass", "inertia")
    )
    yield rows("mass of all presets by the outline", exact, 0.03, mass)
    yield rows("inertia of all presets by the outline", exact, 0.1, inertia)
    modes = frozen_modes(PAIR)
    frozen = modes["lumped frozen"]
    linear = modes["exudyn linear"]
    # exudyn differentiates numerically.
    both = np.stack([linear.ravel(), frozen.ravel()], axis=1)
    yield rows("natural frequencies and damping ratios by exudyn, mesh frozen", "those of A(t)", 1e-6, both)


#: Points on each of the four parts of half a tooth.
_POINTS = 400


@dataclass(frozen=True)
class Blank:
    """One gear body: mass [kg] and inertia [kg m^2] by the outline, and the values of the simulations.

    mass, inertia : by the outline
    error : relative error of both outline values by the polygon
    taken_mass, taken_inertia : values of the simulations
    """

    mass: float
    inertia: float
    error: float
    taken_mass: float
    taken_inertia: float


def blanks(pair: GearPair) -> tuple[Blank, Blank]:
    """Bodies of pinion and gear by their outlines, beside what the simulations take."""
    mass, inertia = masses(pair)
    drawn = circles(pair)
    sides = ((pair.pinion, drawn.base_pinion, drawn.tip_pinion), (pair.gear, drawn.base_gear, drawn.tip_gear))
    result = []
    for i, (gear, base, tip) in enumerate(sides):
        coarse, fine = (_integrals(half_tooth(pair, i, base, tip, n)) for n in (_POINTS, 2 * _POINTS))
        # The polygon errs by the square of its steps: a third of the change is left in the finer one.
        error_left = (fine - coarse) / 3.0
        area, polar = 2.0 * gear.teeth * (fine + error_left)
        hole = math.pi * (0.5 * gear.bore) ** 2
        area = area - hole
        polar = polar - 0.5 * hole * (0.5 * gear.bore) ** 2
        weight = gear.density * gear.face_width
        error = float(np.abs(error_left / fine).max())
        result.append(
            Blank(float(weight * area), float(weight * polar), error, float(mass[i]), float(inertia[i]))
        )
    return result[0], result[1]


def half_tooth(pair: GearPair, gear_name: int, base: float, tip: float, points: int) -> FloatArray:
    """Outline of half a tooth and half a space from the gear's centre, closed, (k, 2) [m]."""
    gear = (pair.pinion, pair.gear)[gear_name]
    profile = pair.wheels[gear_name].tooth
    half = 0.5 * base_tooth_angle(pair, gear_name, base)
    thinned = profile.base_half_angle - half
    length = np.linspace(math.sqrt(tip**2 - base**2), profile.form_length, points)
    flank_angle = half - length / base + np.arctan(length / base)
    flank_radius = np.hypot(base, length)
    bottom, joint = profile.fillet_range
    u, h, _ = profile.fillet_points(np.linspace(joint, bottom, points))
    fillet_angle = np.arctan2(h, u) - thinned
    fillet_radius = np.hypot(u, h)
    top = np.linspace(0.0, float(flank_angle[0]), points)
    root = np.linspace(float(fillet_angle[-1]), math.pi / gear.teeth, points)
    angle = np.concatenate([top, flank_angle, fillet_angle, root])
    radius = np.concatenate(
        [np.full(points, tip), flank_radius, fillet_radius, np.full(points, fillet_radius[-1])]
    )
    rim = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    return np.vstack([np.zeros((1, 2)), rim, np.zeros((1, 2))])


def _integrals(polygon: FloatArray) -> FloatArray:
    """Area and polar second moment of a closed polygon about the origin, (2,) [m^2], [m^4]."""
    a = polygon[:-1]
    b = polygon[1:]
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    spread = np.sum(a * a + a * b + b * b, axis=1)
    return np.array([0.5 * cross.sum(), cross @ spread / 12.0])


#: Bodies of this many times their mass do not move in a few swings of the teeth.
_HEAVY = 1e12
#: Initial amplitude [m]; the system is linear. Samples per run, and length of the run over a period.
_AMPLITUDE = 1e-6
_SAMPLES = 64
_PERIODS = 2.0
_RTOL = 1e-11


@dataclass(frozen=True)
class Decay:
    """One free vibration.

    ``motion`` is "mesh", or "pinion x" to "gear y": a body on its bearing along (x) and off (y) the line of
    action; ``measured`` and ``given`` are damping ratios, of a mesh with several pairs that of their sum.
    """

    motion: str
    frequency: float
    measured: float
    given: float


def damping_check(pair: GearPair) -> tuple[Decay, ...]:
    """Measure the damping ratios of the mesh and of the four bearing directions by free decay."""
    numbers = _frozen(machine(pair))
    p = numbers.record
    fixed = replace(numbers, mass=_HEAVY * numbers.mass)
    q = np.zeros(6)
    q[2], q[5] = -_AMPLITUDE / p.geometry.radius_p, 0.0
    places = _in_contact(numbers)
    k = np.array([max(table_value(numbers.stiffness_table, xi), 0.0) for xi in places])
    share = float(np.sum(np.sqrt(k)) / np.sqrt(np.sum(k)))  # of pairs side by side, each with its own ratio
    mobility = p.geometry.radius_p**2 / numbers.inertia[0] + p.geometry.radius_g**2 / numbers.inertia[1]
    omega = np.sqrt(k.sum() * mobility)
    ratio = pair.mesh.damping_ratio * share
    decays = [_decay("mesh", fixed, q, omega, ratio, numbers.overlap)]
    table = numbers.stiffness_table.copy()
    table[:, 2:] = 0.0
    free = replace(numbers, packed=with_block(numbers.packed, "stiffness", table))
    for i, (name, bearing) in enumerate((("pinion", pair.bearings.pinion), ("gear", pair.bearings.gear))):
        ratios = (bearing.loa_damping_ratio, bearing.oloa_damping_ratio)
        for j, axis in enumerate("xy"):
            q = np.zeros(6)
            read = np.zeros(6)
            q[3 * i + j] = _AMPLITUDE
            read[3 * i + j] = 1.0
            omega = np.sqrt(free.bearing_stiffness[i, j] / free.mass[i])
            decays.append(_decay(f"{name} {axis}", free, q, omega, ratios[j], read))
    return tuple(decays)


def _frozen(numbers: Machine) -> Machine:
    """The machine without friction and torque, held where a pair is in the middle of its path."""
    packed = numbers.packed.copy()
    p = opened(packed)
    single = 0.5 * (p.geometry.L_XA + p.geometry.L_XD)
    time = np.mod(single - p.geometry.L_XA, p.geometry.pitch) / (p.rolling.omega_p * p.geometry.radius_p)
    p.rolling.earliest = time
    p.rolling.latest = time
    p.friction.law = fr.LAWS["none"]
    p.relief_count = 0
    return replace(numbers, packed=packed, torque_pinion=0.0, torque_gear=0.0)


def _in_contact(numbers: Machine) -> FloatArray:
    p = numbers.record
    first = p.geometry.L_XA + p.rolling.earliest * p.rolling.omega_p * p.geometry.radius_p
    return np.arange(first, p.geometry.L_XD, p.geometry.pitch)


def _decay(
    motion: str, numbers: Machine, q: FloatArray, omega: float, given: float, read: FloatArray
) -> Decay:
    """Run from rest at q and fit the motion that ``read`` sees; omega sets how long."""
    times = np.linspace(0.0, _PERIODS * 2.0 * np.pi / omega, _SAMPLES + 1)
    seen: list[FloatArray] = []

    def visit(_number: int, segment: Segment) -> None:
        seen.append(segment.at(times)[0] @ read)

    # Bilateral teeth that do not move along their path: no effect acts, and the phase is held.
    model = build(numbers, 0, 1_000_000)
    edges = times[[0, -1]]
    integrate(model, q, np.zeros(6), edges, rtol=_RTOL, atol=1e-18, clamp=False, visit=visit)
    x = seen[0]
    step = times[1] - times[0]
    # x(n + 2) = s x(n + 1) - p x(n) for every damped oscillator; p is the decrement over one step, squared.
    rows = np.column_stack([x[1:-1], -x[:-2]])
    right = x[2:]
    trace, product = np.linalg.lstsq(rows, right, rcond=None)[0]
    roots = np.log(np.roots([1.0, -trace, product]).astype(complex)) / step
    size = float(np.sqrt(np.real(roots[0] * roots[1])))
    return Decay(motion, size / (2.0 * np.pi), float(-np.real(roots.sum()) / (2.0 * size)), given)


#: Largest residual acceleration of the loaded teeth over that of the load on a free body.
_AT_REST = 1e-9


def frozen_modes(pair: GearPair, phase: float = 0.3) -> dict[str, FloatArray]:
    """Natural frequencies [Hz] and damping ratios with the mesh frozen at a phase: source -> (2, modes)."""
    linear, exact = (prepare(pair, fidelity) for fidelity in ("linear", "exact"))
    time = phase * linear.machine.period
    straight = held(linear, time)
    moving = held(exact, time)
    q = _at_rest(moving, time, exact.q, exact.deflection)
    _, contacts, counts = contact_state(moving, np.array([time]), q[None], np.zeros((1, 6)))
    load = float(contacts[0, : counts[0]]["load"].sum())
    system = periodic_system(pair, "elastic")
    matrix = system.A(time)
    on_turned_line = matrix.copy()
    spring = load / float(exact.machine.record.geometry.L_XY) * np.array([[1.0, -1.0], [-1.0, 1.0]])
    on_turned_line[8:, 3:5] += spring / exact.machine.mass[:, None]
    return {
        "exudyn linear": modes_of(linearised(straight, np.zeros(6))),
        "exudyn exact": modes_of(linearised(moving, q)),
        "lumped frozen": modes_of(np.linalg.eigvals(matrix).astype(np.complex128)),
        "lumped turned line": modes_of(np.linalg.eigvals(on_turned_line).astype(np.complex128)),
    }


def held(setup: Setup, time: float) -> ExudynModel:
    """The model of a set-up with the nominal rotation held at a time; nominal speeds go on sliding."""
    packed = setup.machine.packed.copy()
    rolling = opened(packed).rolling
    rolling.earliest = time
    rolling.latest = time
    return build(replace(setup.machine, packed=packed), setup.model.flags, setup.model.budget.limit)


def _at_rest(model: ExudynModel, time: float, q: FloatArray, scale: float) -> FloatArray:
    """Loaded position near q; the free rotation of the train is held, and its acceleration is left out."""
    p = model.record
    inertia = model.machine.inertia
    rigid = np.array([1.0 / p.geometry.radius_p, -1.0 / p.geometry.radius_g])  # leaves the overlap as it is
    size = model.machine.torque_pinion / float(p.geometry.radius_p) / float(model.machine.mass.min())
    lengths = np.array([1.0, 1.0, p.geometry.radius_p, 1.0, 1.0, p.geometry.radius_g])

    def residual(x: FloatArray) -> FloatArray:
        state = q + scale * x / lengths
        a = accelerations(model, np.array([time]), state[None], np.zeros((1, 6)))[0] * lengths / size
        a[5] += a[2]  # acceleration of the overlap
        a[2] = (state[[2, 5]] - q[[2, 5]]) * inertia @ rigid / (scale * inertia @ rigid**2)
        return np.asarray(a, dtype=np.float64)

    solution = root(residual, np.zeros(6), tol=1e-13)
    assert np.abs(residual(solution.x)).max() < _AT_REST, "no rest at this phase: take one away from a switch"
    return np.asarray(q + scale * solution.x / lengths, dtype=np.float64)


def linearised(model: ExudynModel, q: FloatArray) -> ComplexArray:
    """Eigenvalues of exudyn's linearisation about a position, without those of the free rotation."""
    initial = exu.ConfigurationType.Initial
    model.system.systemData.SetODE2Coordinates(q.tolist(), configuration=initial)
    model.system.systemData.SetODE2Coordinates_t([0.0] * q.size, configuration=initial)
    roots = model.system.ComputeODE2Eigenvalues(computeComplexEigenvalues=True, useAbsoluteValues=False)[0]
    values = np.asarray(roots, dtype=np.complex128)
    return values[np.argsort(np.abs(values))[2:]]


def modes_of(roots: ComplexArray) -> FloatArray:
    """Natural frequencies [Hz] and damping ratios of the roots that oscillate, by frequency, (2, m)."""
    upper = roots[roots.imag > 0.0]
    upper = upper[np.argsort(np.abs(upper))]
    return np.stack([np.abs(upper) / (2.0 * np.pi), -upper.real / np.abs(upper)])
