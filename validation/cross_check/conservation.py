"""Conservation laws that every motion of a gear pair obeys, as checks on both models.

No check compares a variable with itself: the multibody model computes levers, bodies and bearings from the
parameter file, and the checks of the lumped motion use these too. No limit depends on the difference of the
models, so each check can fail whatever the exact motion is.

Sources: the power balance of rigid bodies; docs/theory/multibody.md, "Conservation".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, cast

import numpy as np
import xarray as xr

import multibody
from lumped import GearPair
from lumped.model.equations import COORDINATES, THETA_G, THETA_P, X_P
from lumped.model.periodic_system import LTVSystem
from lumped.model.propagation import fastest_frequency
from lumped.model.results import corner_force, response
from lumped.model.steady import PeriodicSolution, periodic_solution
from lumped.path_of_contact.stiffness import stiffness_factor
from lumped.quasi_static.contacts import contact_of
from lumped.quasi_static.transmission_error import static_transmission_error
from lumped.stiffness.table import TableStiffness
from lumped.typing import FloatArray
from multibody.contact.elements import table_value
from multibody.contact.machine import Machine
from validation.cross_check.agreement import Fidelity
from validation.cross_check.verdict import Judgement

Powers = Mapping[str, Mapping[str, float]]

#: Power -> the power in words. The sum of these powers is the driving power.
POWERS: Mapping[str, str] = {
    "braking": "taken by the brake",
    "friction": "sliding friction of the teeth",
    "bearings": "damping of the bearings",
    "mesh_damping": "damping of the teeth",
    "mesh_stiffness": "work of the change of stiffness and profile along the path",
}
#: Gauss's rule of a panel.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)
#: Least number of panels of the quadrature in a mesh cycle, and largest angle of the fastest vibration in a
#: panel [rad]. A power swings twice as fast as the vibration. The error of Gauss's rule with four nodes is
#: then some 1e-12 of the power.
_PANELS = 160
_PANEL_ANGLE = 0.7
#: Rounding of a product of a coefficient and a velocity over the largest one.
_ROUNDING = 1e-9
#: Phases at which load over stiffness is checked, and fit error of the shares of all pairs over the largest
#: stiffness.
_PHASES = 256
_SHARES = 1e-8
#: Laws that several checks of one model stand for.
_FAMILIES = ("action and reaction", "mean bearing load", "power ")
#: Share of the driving power that the integration may lose at each fidelity. The fastest vibration takes
#: about ten steps, and each step may lose the relative tolerance: so this is ten times the tolerance.
_INTEGRATION: Mapping[str, float] = {"lumped": 1e-8, "linear": 1e-8, "exact": 1e-6}


def conservation(
    pair: GearPair,
    m: Machine,
    reference: xr.Dataset,
    runs: Mapping[Fidelity, xr.Dataset],
    weighted: WeightedMotion | None,
    *,
    periodic: bool,
) -> tuple[tuple[Judgement, ...], Powers]:
    """Check both models. Return the checks, and model -> power -> mean over the mesh cycle [W].

    Parameters
    ----------
    pair : the gear pair
    m : the numbers of the pair as the multibody model derives them
    reference : the lumped periodic motion over one mesh cycle, without the end of the cycle
    runs : fidelity -> multibody motion over whole cycles, with the end of the last cycle
    weighted : the lumped motion with the weights of a quadrature; None with loss of contact, where only
        "exact" has powers
    periodic : whether the motion at "exact" repeats
    """
    samples = reference.sizes["time"]
    motions = {"lumped": reference} | {
        name: run.isel(time=slice(-samples - 1, -1)) for name, run in runs.items()
    }
    powers: dict[str, Mapping[str, float]] = {}
    histories = _mesh_histories(pair, reference)
    if weighted is not None:
        powers["lumped"] = lumped_powers(weighted, m)
        histories = _mesh_histories(pair, weighted.motion.values)  # on both sides of every jump
    for fidelity in runs:
        if periodic if fidelity == "exact" else weighted is not None:
            rtol = 1e-8 if fidelity == "exact" else 1e-10
            balance = multibody.motion_balance(pair, motions[fidelity], rtol)
            powers[fidelity] = multibody_powers(balance, m.period)
    variation = tuple(float(np.abs(np.diff(h, append=h[:1])).sum()) for h in histories)
    checks = []
    for name, motion in motions.items():
        checks.append(_friction_takes_power(m, name, runs.get(cast(Fidelity, name), motion)))
        if name != "exact" or periodic:
            checks += _action_and_reaction(m, name, motion)
        if name != "exact":
            checks += _mean_bearing_loads(m, name, motion, pair, variation)
    checks += _load_over_stiffness(pair, m)
    for name, of_model in powers.items():
        checks += _first_law(name, of_model)
    if "linear" in powers and "lumped" in powers:
        checks += _same_powers(powers["lumped"], powers["linear"])
    if "exact" in powers and contact_of(pair).conservative:
        exact = powers["exact"]
        checks.append(
            Judgement(
                "conservation: energy of the contact, exact",
                abs(exact["mesh_stiffness"]) / exact["driving"],
                _INTEGRATION["exact"],
                "what a contact with an energy stores it returns; over the driving power; limit: the error "
                "of the integration",
            )
        )
    return tuple(checks), powers


class WeightedMotion(NamedTuple):
    """Lumped periodic motion at the times of ``quadrature``, and the weights (k,) of these times."""

    motion: PeriodicSolution
    weights: FloatArray


def lumped_motion(pair: GearPair) -> WeightedMotion:
    """Lumped periodic motion of a pair at the times of ``quadrature``."""
    system = LTVSystem.of(pair, "full", supports="springs")
    times, weights = quadrature(system)
    return WeightedMotion(periodic_solution(system, times, estimate_error=False), weights)


def quadrature(system: LTVSystem) -> tuple[FloatArray, FloatArray]:
    """Times (k,) in the mesh cycle and weights (k,). The sum of the weights is one.

    Every law is one polynomial in each panel.
    """
    angle = fastest_frequency(system) * system.period
    even = np.linspace(0.0, system.period, max(_PANELS, int(np.ceil(angle / _PANEL_ANGLE))) + 1)
    marks = np.union1d(system.cycle.breaks, even)
    marks = marks[np.diff(marks, prepend=-np.inf) > 1e-9 * system.period]
    marks[-1] = system.period
    width = np.diff(marks)[:, None]
    times = (marks[:-1, None] + 0.5 * width * (1.0 + _NODES)).ravel()
    return times, (0.5 * width * _WEIGHTS).ravel() / system.period


def lumped_powers(weighted: WeightedMotion, machine: Machine) -> dict[str, float]:
    """Mean powers of the lumped periodic motion: "driving" and ``POWERS`` [W].

    machine : the numbers of the pair as the multibody model derives them
    """
    motion, weights = weighted
    rolling = machine.record.rolling
    rates = motion.states[:, len(COORDINATES) :]
    driving = float(rolling.omega_p + weights @ rates[:, THETA_P])
    braking = float(rolling.omega_g + weights @ rates[:, THETA_G])
    return losses(motion.system, machine, motion.time, motion.states, weights) | {
        "driving": motion.pinion_torque * driving,
        "braking": motion.brake_torque * braking,
    }


def losses(
    system: LTVSystem, machine: Machine, times: FloatArray, states: FloatArray, weights: FloatArray
) -> dict[str, float]:
    """Mean powers that a lumped motion loses [W], from times (k,), states (k, 12) and weights (k,)."""
    p = machine.record
    values = response(system, times, states)
    pairs = system.cycle.sample(times)
    rates = states[:, len(COORDINATES) :]
    theta_p, theta_g, x_p, x_g, y_p, y_g = rates.T
    place = values["position"]
    sliding = (p.rolling.omega_p + theta_p) * place
    sliding -= (p.rolling.omega_g + theta_g) * (p.geometry.L_XY - place) + y_p - y_g
    closing = p.geometry.radius_p * theta_p - p.geometry.radius_g * theta_g + x_p - x_g
    # A tip corner closes by less than the gears approach. The damping contains this factor once.
    share = 1.0 if pairs.closing is None else pairs.closing
    damping = np.sum(share * pairs.damping * (closing - pairs.error_rate) ** 2, axis=0)
    corners = corner_force(values, pairs) * (y_g - y_p)
    bearings = machine.bearing_damping.T.ravel()  # x_p, x_g, y_p, y_g
    return {
        "friction": float(weights @ np.sum(values["friction_force"] * sliding, axis=0)),
        "bearings": float(weights @ (rates[:, X_P:] ** 2 @ bearings)),
        "mesh_damping": float(weights @ damping),
        "mesh_stiffness": float(weights @ (values["normal_load"].sum(axis=0) * closing - damping - corners)),
    }


def multibody_powers(balance: multibody.PowerBalance, period: float) -> dict[str, float]:
    """Mean powers of a multibody run over one mesh cycle: "driving" and ``POWERS`` [W].

    The power that the bodies and bearings store is taken off the driving power.
    """
    mean = {name: float(getattr(balance, name)) / period for name in POWERS}
    return mean | {"driving": (balance.driving - balance.kinetic) / period}


def residual(powers: Mapping[str, float]) -> float:
    """Driving power that is not accounted for, over the driving power."""
    return abs(powers["driving"] - sum(powers[name] for name in POWERS)) / abs(powers["driving"])


def worst_of_each(checks: Sequence[Judgement]) -> tuple[Judgement, ...]:
    """The check with the largest value over the limit, for each law and model. For a short table."""
    groups: dict[tuple[str, str], Judgement] = {}
    for check in checks:
        law, model = check.check.removeprefix("conservation: ").rsplit(", ", 1)
        law = next((name for name in _FAMILIES if law.startswith(name)), law)
        best = groups.get((law, model))
        if best is None or check.value / check.limit > best.value / best.limit:
            groups[law, model] = check
    return tuple(groups.values())


def _mesh_histories(
    pair: GearPair, motion: Mapping[str, FloatArray] | xr.Dataset
) -> tuple[FloatArray, FloatArray]:
    """Sums over all pairs: moment of friction about the pinion, and force on the pinion across the line."""
    load, force, place = (np.asarray(motion[name]) for name in ("normal_load", "friction_force", "position"))
    tilt = contact_of(pair).elements(pair).tilt
    across = force
    if tilt is not None:
        across = force - tilt(place) * load
    return (force * place).sum(axis=0), across.sum(axis=0)


def _friction_takes_power(m: Machine, name: str, motion: xr.Dataset) -> Judgement:
    """Sliding friction takes power at every instant and every contact."""
    p = m.record
    if name == "exact":
        taken = (motion["friction_force"] * motion["sliding_velocity"]).to_numpy()
        text = "friction force times sliding velocity of every contact at every time, over the largest"
    else:
        place = motion["position"].to_numpy()
        nominal = p.rolling.omega_p * place - p.rolling.omega_g * (p.geometry.L_XY - place)
        taken = motion["mu"].to_numpy() * nominal
        text = "coefficient times nominal sliding velocity of every contact at every time, over the largest"
    largest = max(float(np.abs(taken).max()), np.finfo(float).tiny)
    fed_in = max(0.0, -float(taken.min())) / largest
    return Judgement(f"conservation: friction takes power, {name}", fed_in, _ROUNDING, f"{text}; rounding")


def _load_over_stiffness(pair: GearPair, m: Machine) -> list[Judgement]:
    """A stiffness of the whole mesh is load over transmission error. Both models must return this error.

    With the stiffness of a tooth pair there is nothing to check.
    """
    table = pair.mesh.stiffness
    if not isinstance(table, TableStiffness) or not table.whole_mesh:
        return []
    p = m.record
    static = static_transmission_error(pair, phases=_PHASES)
    phase = static["phase"].to_numpy()
    stated = stiffness_factor(pair) * table.total(pair.geometry, phase)
    force = m.torque_pinion / p.geometry.radius_p
    # Between the phases: at A and D themselves rounding decides whether a pair is in contact.
    between = phase + 0.5 / _PHASES
    place = p.geometry.L_XA + p.geometry.pitch * (between[:, None] + np.arange(m.pairs))
    stiffness = np.array([[table_value(m.stiffness_table, xi) for xi in row] for row in place])
    second = np.where(place < p.geometry.L_XD, stiffness, 0.0).sum(axis=1)
    errors = {
        "lumped": (static["transmission_error"].to_numpy()[0], force / stated),
        "exact": (
            force / second,
            force / (stiffness_factor(pair) * table.total(pair.geometry, between)),
        ),
    }
    limit = _SHARES * float(stated.max() / stated.min())
    return [
        Judgement(
            f"conservation: load over stiffness of the whole mesh, {name}",
            float(np.abs(error / expected - 1.0).max()),
            limit,
            "static transmission error at every phase against T_p/r_bp over the stiffness as given; limit: "
            "the fit of the shares of the pairs",
        )
        for name, (error, expected) in errors.items()
    ]


def _action_and_reaction(m: Machine, name: str, motion: xr.Dataset) -> list[Judgement]:
    """The teeth push both gears alike: the momentum of both changes by their bearing forces alone."""
    time = motion["time"].to_numpy()
    checks = []
    for j, axis in enumerate("xy"):
        momentum, work, coarse = (np.zeros(time.size) for _ in range(3))
        scale = 0.0
        for i, gear in enumerate("pg"):
            x, v = (motion[f"{axis}_{gear}{suffix}"].to_numpy() for suffix in ("", "_dot"))
            k = m.bearing_stiffness[i, j]
            c = m.bearing_damping[i, j]
            momentum += m.mass[i] * (v - v[0]) + c * (x - x[0])
            work += k * _integral(time, x, v)
            coarse += k * _integral(time, x, v, 2)
            scale = max(scale, k * float(np.abs(x).max()) * m.period)
        # Without friction nothing moves off the line of action: then the load is the scale.
        scale = max(scale, 1e-6 * m.torque_pinion / m.record.geometry.radius_p * m.period)
        # At every second time the coarser quadrature tells the error.
        residual_impulse = float(np.abs(momentum + work)[::2].max()) / scale
        error = float(np.abs(coarse - work)[::2].max()) / scale
        checks.append(
            Judgement(
                f"conservation: action and reaction {axis}, {name}",
                residual_impulse,
                error + 1e-6,
                "momentum of both gears against the impulse of their bearings, over the largest bearing "
                "force times the mesh cycle; limit: what twice the step changes in the quadrature",
            )
        )
    return checks


def _integral(time: FloatArray, x: FloatArray, v: FloatArray, every: int = 1) -> FloatArray:
    """Integral (k,) of x from the first time on, by Hermite's cubic over every second, third ... time.

    Between these times the integral stays constant.
    """
    t = time[::every]
    y = x[::every]
    rate = v[::every]
    h = np.diff(t)
    parts = 0.5 * h * (y[1:] + y[:-1]) + h**2 / 12.0 * (rate[:-1] - rate[1:])
    sums = np.concatenate([[0.0], np.cumsum(parts)])
    return np.repeat(sums, every)[: time.size]


def _mean_bearing_loads(
    m: Machine, name: str, motion: xr.Dataset, pair: GearPair, variation: Sequence[float]
) -> list[Judgement]:
    """Mean moments of the pinion, and mean forces of each gear off the line of action.

    The mean of N even samples of a periodic history errs by at most the variation of the history over N.

    variation : variations of both ``_mesh_histories``
    """
    p = m.record
    k_p, k_g = m.bearing_stiffness
    moment, total = _mesh_histories(pair, motion)
    load = pair.operating.pinion_torque / p.geometry.radius_p
    along = load - moment.mean() / p.geometry.radius_p
    across = total.mean()
    stiffness = {"x_p": -k_p[0], "x_g": k_g[0], "y_p": k_p[1], "y_g": -k_g[1]}
    sampled = {
        "x": variation[0] / moment.size / p.geometry.radius_p / load,
        "y": variation[1] / moment.size / load,
    }
    return [
        Judgement(
            f"conservation: mean bearing load {axis}, {name}",
            abs(float(k * motion[axis].to_numpy().mean() - (along if axis[0] == "x" else across))) / load,
            sampled[axis[0]] + _missed(motion, axis) * abs(k) / load + 1e-6,
            "T_p/r_bp less the mean moment of friction, or mean friction and corners; limit: what even times "
            "can miss of a history that jumps, its variation in the lumped model over their number, and of "
            "the displacement",
        )
        for axis, k in stiffness.items()
    ]


def _missed(motion: xr.Dataset, name: str) -> float:
    """Largest error of the mean of a displacement at even times: step^2/8 times the variation of the rate."""
    rate = motion[f"{name}_dot"].to_numpy()
    time = motion["time"].to_numpy()
    step = float(time[1] - time[0])
    return step * float(np.abs(np.diff(rate, append=rate[:1])).sum()) / (8.0 * rate.size)


def _first_law(name: str, powers: Mapping[str, float]) -> list[Judgement]:
    law = Judgement(
        f"conservation: first law, {name}",
        residual(powers),
        _INTEGRATION[name],
        "driving power less brake, friction, bearings, damping of the teeth and the work of the change "
        "of stiffness and profile, over the driving power; limit: the error of the integration",
    )
    # Each power of "linear" is compared with the lumped power. At "exact" the first law and the law of
    # friction leave no other efficiency.
    if name != "lumped":
        return [law]
    efficiency = powers["braking"] / powers["driving"]
    outside = max(efficiency - 1.0, 0.0 if efficiency > 0.0 else 1.0 - efficiency, 0.0)
    text = f"how far the efficiency, {efficiency:.6f}, lies outside (0, 1]; the error of the integration"
    return [law, Judgement(f"conservation: efficiency, {name}", outside, _INTEGRATION[name], text)]


def _same_powers(lumped: Mapping[str, float], linear: Mapping[str, float]) -> list[Judgement]:
    """At "linear" every power equals the power of the lumped model."""
    return [
        Judgement(
            f"conservation: power {power}, linear",
            abs(linear[power] - lumped[power]) / lumped["driving"],
            _INTEGRATION["linear"],
            f"power {text} of both models, difference over the driving power; the same equations: only "
            "integration error may remain",
        )
        for power, text in POWERS.items()
    ]
