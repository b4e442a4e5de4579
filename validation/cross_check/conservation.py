"""Conservation laws that every motion of a gear pair obeys, as checks on both models.

No check compares a variable with itself: levers, bodies and bearings are those that the multibody model works
out from the parameter file, also where the lumped motion is checked. No limit depends on how far the models
are apart, so each check can fail whatever the exact motion is.

Sources: the power balance of rigid bodies; docs/theory/multibody.md, "Conservation".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import cast

import numpy as np
import xarray as xr

import multibody
from lumped import GearPair
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

#: Power -> what it is in words. Their sum is the driving power.
POWERS: Mapping[str, str] = {
    "braking": "taken by the brake",
    "friction": "sliding friction of the teeth",
    "bearings": "damping of the bearings",
    "mesh_damping": "damping of the teeth",
    "mesh_stiffness": "work of the change of stiffness and profile along the path",
}
#: Gauss's rule of a panel.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)
#: Panels of the quadrature in a mesh cycle, at least, and largest angle of the fastest vibration in a panel
#: [rad]: Gauss's rule with four nodes then leaves some 1e-12 of a power, which swings twice as fast.
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
#: Share of the driving power that the integration may lose at each fidelity: ten times its relative tolerance
#: for every one of the ten steps or so of the fastest vibration.
_INTEGRATION: Mapping[str, float] = {"lumped": 1e-8, "linear": 1e-8, "exact": 1e-6}


def conservation(
    pair: GearPair,
    m: Machine,
    reference: xr.Dataset,
    runs: Mapping[Fidelity, xr.Dataset],
    own: tuple[PeriodicSolution, FloatArray] | None,
    *,
    periodic: bool,
) -> tuple[tuple[Judgement, ...], Powers]:
    """Check both models; return the checks, and model -> power -> mean over the mesh cycle [W].

    ``m`` has the pair's numbers as the multibody model derives them. ``reference`` is the lumped periodic
    motion over one mesh cycle without its end, ``runs`` fidelity -> multibody motion over whole cycles with
    the last end, ``periodic`` whether "exact" repeats. ``own`` is what ``lumped_motion`` returns; None
    with loss of contact, and powers are those of "exact" alone.
    """
    samples = reference.sizes["time"]
    motions = {"lumped": reference} | {
        name: run.isel(time=slice(-samples - 1, -1)) for name, run in runs.items()
    }
    powers: dict[str, Mapping[str, float]] = {}
    histories = _mesh_histories(pair, reference)
    if own is not None:
        powers["lumped"] = lumped_powers(own[0], m, own[1])
        histories = _mesh_histories(pair, own[0].values)  # on both sides of every jump
    for fidelity in runs:
        if periodic if fidelity == "exact" else own is not None:
            rtol = 1e-8 if fidelity == "exact" else 1e-10
            balance = multibody.motion_balance(pair, motions[fidelity], rtol)
            powers[fidelity] = multibody_powers(balance, m.period)
    variation = tuple(float(np.abs(np.diff(h, append=h[:1])).sum()) for h in histories)
    found = []
    for name, motion in motions.items():
        found.append(_friction_takes_power(m, name, runs.get(cast(Fidelity, name), motion)))
        if name != "exact" or periodic:
            found += _action_and_reaction(m, name, motion)
        if name != "exact":
            found += _mean_bearing_loads(m, name, motion, pair, variation)
    found += _load_over_stiffness(pair, m)
    for name, one in powers.items():
        found += _first_law(name, one)
    if "linear" in powers and "lumped" in powers:
        found += _same_powers(powers["lumped"], powers["linear"])
    if "exact" in powers and contact_of(pair).conservative:
        exact = powers["exact"]
        found.append(
            Judgement(
                "conservation: energy of the contact, exact",
                abs(exact["mesh_stiffness"]) / exact["driving"],
                _INTEGRATION["exact"],
                "what a contact with an energy stores it returns; over the driving power; limit: the error "
                "of the integration",
            )
        )
    return tuple(found), powers


def lumped_motion(pair: GearPair) -> tuple[PeriodicSolution, FloatArray]:
    """Lumped periodic motion at the times of ``quadrature``, and their weights."""
    system = LTVSystem.of(pair, "full", supports="springs")
    times, weights = quadrature(system)
    return periodic_solution(system, times, estimate_error=False), weights


def quadrature(system: LTVSystem) -> tuple[FloatArray, FloatArray]:
    """Times in the mesh cycle and their weights, which sum to one; in no panel a law is two polynomials."""
    angle = fastest_frequency(system) * system.period
    even = np.linspace(0.0, system.period, max(_PANELS, int(np.ceil(angle / _PANEL_ANGLE))) + 1)
    marks = np.union1d(system.cycle.breaks, even)
    marks = marks[np.diff(marks, prepend=-np.inf) > 1e-9 * system.period]
    marks[-1] = system.period
    width = np.diff(marks)[:, None]
    times = (marks[:-1, None] + 0.5 * width * (1.0 + _NODES)).ravel()
    return times, (0.5 * width * _WEIGHTS).ravel() / system.period


def lumped_powers(motion: PeriodicSolution, machine: Machine, weights: FloatArray) -> dict[str, float]:
    """Mean powers of the lumped periodic motion at the times of ``quadrature``: "driving" and ``POWERS`` [W].

    ``machine`` has the pair's numbers as the multibody model derives them.
    """
    p = machine.record
    found = losses(motion.system, machine, motion.time, motion.states, weights)
    return found | {
        "driving": motion.pinion_torque * float(p.rolling.omega_p + weights @ motion.states[:, 6]),
        "braking": motion.brake_torque * float(p.rolling.omega_g + weights @ motion.states[:, 7]),
    }


def losses(
    system: LTVSystem, machine: Machine, times: FloatArray, states: FloatArray, weights: FloatArray
) -> dict[str, float]:
    """Mean powers of what a lumped motion loses [W], from (k,) times, (k, 12) states and (k,) weights."""
    p = machine.record
    values = response(system, times, states)
    pairs = system.cycle.sample(times)
    rates = states[:, 6:]
    place = values["position"]
    sliding = (p.rolling.omega_p + rates[:, 0]) * place
    sliding -= (p.rolling.omega_g + rates[:, 1]) * (p.geometry.L_XY - place) + rates[:, 4] - rates[:, 5]
    closing = (
        p.geometry.radius_p * rates[:, 0] - p.geometry.radius_g * rates[:, 1] + rates[:, 2] - rates[:, 3]
    )
    # A tip corner closes by less than the gears approach; damping holds that factor once.
    share = 1.0 if pairs.closing is None else pairs.closing
    damping = np.sum(share * pairs.damping * (closing - pairs.error_rate) ** 2, axis=0)
    corners = corner_force(values, pairs) * (rates[:, 5] - rates[:, 4])
    bearings = machine.bearing_damping.T.ravel()  # x_p, x_g, y_p, y_g
    return {
        "friction": float(weights @ np.sum(values["friction_force"] * sliding, axis=0)),
        "bearings": float(weights @ (rates[:, 2:] ** 2 @ bearings)),
        "mesh_damping": float(weights @ damping),
        "mesh_stiffness": float(weights @ (values["normal_load"].sum(axis=0) * closing - damping - corners)),
    }


def multibody_powers(balance: multibody.PowerBalance, period: float) -> dict[str, float]:
    """The same of a multibody run over one mesh cycle; what it stored counts as driving power less [W]."""
    found = {name: float(getattr(balance, name)) / period for name in POWERS}
    return found | {"driving": (balance.driving - balance.kinetic) / period}


def residual(powers: Mapping[str, float]) -> float:
    """Driving power that is not accounted for, over the driving power."""
    return abs(powers["driving"] - sum(powers[name] for name in POWERS)) / abs(powers["driving"])


def worst_of_each(checks: Sequence[Judgement]) -> tuple[Judgement, ...]:
    """Of each law and model the check that uses most of its limit, for a short table."""
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
    """Moment of friction about the pinion, and the force on it off the line of action, of all pairs."""
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
    """A stiffness of the whole mesh is load over transmission error: both models must give that error back.

    Nothing to check with the stiffness of a tooth pair.
    """
    table = pair.mesh.stiffness
    if not isinstance(table, TableStiffness) or not table.whole_mesh:
        return []
    p = m.record
    static = static_transmission_error(pair, phases=_PHASES)
    phase = static["phase"].to_numpy()
    given = stiffness_factor(pair) * table.total(pair.geometry, phase)
    force = m.torque_pinion / p.geometry.radius_p
    # Not at A and D themselves, on which rounding decides whether a pair is there.
    between = phase + 0.5 / _PHASES
    place = p.geometry.L_XA + p.geometry.pitch * (between[:, None] + np.arange(m.pairs))
    stiffness = np.array([[table_value(m.stiffness_table, xi) for xi in row] for row in place])
    second = np.where(place < p.geometry.L_XD, stiffness, 0.0).sum(axis=1)
    errors = {
        "lumped": (static["transmission_error"].to_numpy()[0], force / given),
        "exact": (
            force / second,
            force / (stiffness_factor(pair) * table.total(pair.geometry, between)),
        ),
    }
    limit = _SHARES * float(given.max() / given.min())
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
    found = []
    for j, axis in enumerate("xy"):
        momentum, work, coarse = (np.zeros(time.size) for _ in range(3))
        scale = 0.0
        for i, gear in enumerate("pg"):
            x, v = (motion[f"{axis}_{gear}{suffix}"].to_numpy() for suffix in ("", "_dot"))
            k, c = m.bearing_stiffness[i, j], m.bearing_damping[i, j]
            momentum += m.mass[i] * (v - v[0]) + c * (x - x[0])
            work += k * _integral(time, x, v)
            coarse += k * _integral(time, x, v, 2)
            scale = max(scale, k * float(np.abs(x).max()) * m.period)
        # Without friction nothing moves off the line of action: then the load is the scale.
        scale = max(scale, 1e-6 * m.torque_pinion / m.record.geometry.radius_p * m.period)
        off = float(np.abs(momentum + work)[::2].max()) / scale  # where the coarser one tells the error
        error = float(np.abs(coarse - work)[::2].max()) / scale
        found.append(
            Judgement(
                f"conservation: action and reaction {axis}, {name}",
                off,
                error + 1e-6,
                "momentum of both gears against the impulse of their bearings, over the largest bearing "
                "force times the mesh cycle; limit: what twice the step changes in the quadrature",
            )
        )
    return found


def _integral(time: FloatArray, x: FloatArray, v: FloatArray, every: int = 1) -> FloatArray:
    """Integral of x from the first time on, by Hermite's cubic, (k,); a coarser one is held between."""
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

    The mean of N even samples of a periodic history is off by no more than its variation over N.
    ``variation`` is that of both ``_mesh_histories``.
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
    """What even times can miss of the mean of a displacement: step^2/8 times the variation of its rate."""
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
    if (
        name != "lumped"
    ):  # each power of "linear" is the lumped one; "exact" keeps this law and that of friction
        return [law]
    efficiency = powers["braking"] / powers["driving"]
    outside = max(efficiency - 1.0, 0.0 if efficiency > 0.0 else 1.0 - efficiency, 0.0)
    text = f"how far the efficiency, {efficiency:.6f}, lies outside (0, 1]; the error of the integration"
    return [law, Judgement(f"conservation: efficiency, {name}", outside, _INTEGRATION[name], text)]


def _same_powers(own: Mapping[str, float], linear: Mapping[str, float]) -> list[Judgement]:
    return [
        Judgement(
            f"conservation: power {power}, linear",
            abs(linear[power] - own[power]) / own["driving"],
            _INTEGRATION["linear"],
            f"power {text} of both models, difference over the driving power; the same equations: only "
            "integration error may remain",
        )
        for power, text in POWERS.items()
    ]
