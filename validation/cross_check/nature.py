"""Laws of nature that every motion of a gear pair obeys, as checks on both models.

No check compares a variable with itself: levers, bodies and bearings are those that the multibody model works
out from the parameter file, also where the lumped motion is checked.

Sources: docs/theory/multibody.md, "Laws of nature".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

import multibody
from lumped import GearPair
from lumped.model.periodic_system import LTVSystem, periodic_system
from lumped.model.steady import PeriodicSolution, periodic_solution
from lumped.typing import FloatArray
from multibody.contact import kernels as kn
from multibody.contact.machine import Machine, machine
from multibody.run.setup import prepare
from multibody.study.balance import balance_of
from validation.cross_check.agreement import FIDELITIES, Fidelity
from validation.cross_check.judgement import Judgement
from validation.cross_check.ledger import (
    LOSSES,
    POWERS,
    lumped_powers,
    multibody_powers,
    paid_by_the_brake,
    quadrature,
    residual,
)

#: Rounding of a product of a coefficient and a velocity over the largest one.
_ROUNDING = 1e-9
#: Laws that several checks of one model stand for.
_FAMILIES = ("action and reaction", "mean bearing load", "power ")
#: Share of the driving power that the integration may lose at each fidelity: ten times its relative tolerance
#: for every one of the ten steps or so of the fastest vibration.
_INTEGRATION: Mapping[str, float] = {"lumped": 1e-8, "linear": 1e-8, "exact": 1e-6}


def laws_of_nature(
    pair: GearPair,
    reference: xr.Dataset,
    exact: xr.Dataset | None,
    runs: Mapping[Fidelity, xr.Dataset],
    most: Mapping[str, float],
    shift: float,
    push: FloatArray,
) -> tuple[tuple[Judgement, ...], Mapping[str, Mapping[str, float]]]:
    """Check both models.

    Parameters
    ----------
    pair : a validated gear pair
    reference : lumped periodic motion, one mesh cycle without its end
    exact : periodic motion of the exact model over one mesh cycle without its end; None where it has none
    runs : fidelity -> motion of the multibody model over whole cycles, the last end included
    most : power -> largest first-order change by finite motions, over the driving power
    shift : of the contact, over the base pitch
    push : (6,) mean generalised forces of the teeth beside normal load and friction, in the exact model

    Returns
    -------
    the checks, and model -> power -> mean over the mesh cycle [W]
    """
    m, system = machine(pair), periodic_system(pair, "full")
    times, weights = quadrature(system)
    own = periodic_solution(system, times, estimate_error=False)
    powers = {"lumped": lumped_powers(own, m, weights)}
    variation = _variation(own)
    balance = multibody.power_balance(pair, 1, fidelity="linear", initial="periodic", rtol=1e-10)
    powers["linear"] = multibody_powers(balance, m.period)
    motions = {"lumped": reference}
    if "linear" in runs:
        motions["linear"] = runs["linear"].isel(time=slice(-reference.sizes["time"] - 1, -1))
    if exact is not None:
        motions["exact"] = exact
        powers["exact"] = _exact_powers(pair, system, exact, m.period)
    found = [_friction(m, "lumped", reference)]
    found += [_friction(m, name, run) for name, run in runs.items()]
    for name, motion in motions.items():
        allowed, beside = (shift, push) if name == "exact" else (0.0, np.zeros(6))
        found += _action_and_reaction(m, name, motion)
        found += _statics(m, name, motion, pair.operating.pinion_torque, allowed, variation, beside)
    for name, one in powers.items():
        found += _first_law(name, one)
    found += _power_by_power(powers, most, shift, paid=pair.mesh.contact == "loaded")
    return tuple(found), powers


def laws_where_teeth_part(
    pair: GearPair,
    reference: xr.Dataset,
    exact: xr.Dataset | None,
    runs: Mapping[Fidelity, xr.Dataset],
    shift: float,
    push: FloatArray,
) -> tuple[tuple[Judgement, ...], Mapping[str, Mapping[str, float]]]:
    """The same of motions with loss of contact, without the powers of the lumped model."""
    m = machine(pair)
    force = reference["friction_force"].to_numpy()
    moment = (force * reference["position"].to_numpy()).sum(axis=0)
    # Force and moment may jump where teeth meet or part, once each in a cycle and more.
    variation = {name: _varied(one) for name, one in (("moment", moment), ("force", force.sum(axis=0)))}
    samples = reference.sizes["time"]
    motions = {"lumped": reference} | {
        name: runs[name].isel(time=slice(-samples - 1, -1)) for name in FIDELITIES if name in runs
    }
    found, powers = list[Judgement](), dict[str, Mapping[str, float]]()
    for name, motion in motions.items():
        allowed, beside = (shift, push) if name == "exact" else (0.0, np.zeros(6))
        found.append(_friction(m, name, motion))
        found += _action_and_reaction(m, name, motion)
        found += _statics(m, name, motion, pair.operating.pinion_torque, allowed, variation, beside)
    if exact is not None:
        powers["exact"] = _exact_powers(pair, periodic_system(pair, "full"), exact, m.period)
        found += _first_law("exact", powers["exact"])
    return tuple(found), powers


def nature_groups(checks: Sequence[Judgement]) -> tuple[Judgement, ...]:
    """Of each law and model the check that uses most of its limit, for a short table."""
    groups: dict[tuple[str, str], Judgement] = {}
    for check in checks:
        law, model = check.check.rsplit(", ", 1)
        law = next((name for name in _FAMILIES if law.startswith(f"nature: {name}")), law)
        best = groups.get((law, model))
        if best is None or check.value / check.limit > best.value / best.limit:
            groups[law, model] = check
    return tuple(groups.values())


def fed_back(reference: xr.Dataset) -> float:
    """Share of the friction power that vibration feeds back, because it reverses the sliding.

    The lumped model keeps the sign of friction that belongs to the nominal sliding. Where vibration reverses
    the sliding it feeds power in: a limit of the model's validity, not a wrong sign.
    """
    power = reference["friction_power"].to_numpy()
    size = float(np.abs(power).sum())
    return float(power[power > 0.0].sum()) / size if size > 0.0 else 0.0


def _exact_powers(pair: GearPair, system: LTVSystem, exact: xr.Dataset, period: float) -> dict[str, float]:
    state = np.array([float(exact[name][0]) for name in system.state_names])
    effects = str(exact.attrs["effects"]).split(", ")
    velocity = float(exact.attrs["friction_velocity"])
    setup = prepare(pair, "exact", state, effects, friction_velocity=velocity)
    setup = setup.with_torques(setup.machine.torque_pinion, float(exact.attrs["brake_torque"]))
    return multibody_powers(balance_of(setup, 1), period)


def _friction(m: Machine, name: str, motion: xr.Dataset) -> Judgement:
    """Sliding friction takes power at every instant and every contact."""
    p = m.parameters
    if name == "exact":
        taken = (motion["friction_force"] * motion["sliding_velocity"]).to_numpy()
        text = "friction force times sliding velocity of every contact at every time, over the largest"
    else:
        place = motion["position"].to_numpy()
        nominal = p[kn.OMEGA_P] * place - p[kn.OMEGA_G] * (p[kn.L_XY] - place)
        taken = motion["mu"].to_numpy() * nominal
        text = "coefficient times nominal sliding velocity of every contact at every time, over the largest"
    largest = max(float(np.abs(taken).max()), np.finfo(float).tiny)
    fed_in = max(0.0, -float(taken.min())) / largest
    return Judgement(f"nature: friction takes power, {name}", fed_in, _ROUNDING, f"{text}; rounding")


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
        scale = max(scale, 1e-6 * m.torque_pinion / m.parameters[kn.RADIUS_P] * m.period)
        off = float(np.abs(momentum + work).max()) / scale
        error = float(np.abs(coarse - work)[::2].max()) / scale
        found.append(
            Judgement(
                f"nature: action and reaction {axis}, {name}",
                off,
                error + 1e-6,
                "momentum of both gears against the impulse of their bearings, over the largest bearing "
                "force times the mesh cycle; limit: what twice the step changes in the quadrature",
            )
        )
    return found


def _integral(time: FloatArray, x: FloatArray, v: FloatArray, every: int = 1) -> FloatArray:
    """Integral of x from the first time on, by Hermite's cubic, (k,); a coarser one is held between."""
    t, y, rate = time[::every], x[::every], v[::every]
    h = np.diff(t)
    parts = 0.5 * h * (y[1:] + y[:-1]) + h**2 / 12.0 * (rate[:-1] - rate[1:])
    sums = np.concatenate([[0.0], np.cumsum(parts)])
    return np.repeat(sums, every)[: time.size]


def _statics(
    m: Machine,
    name: str,
    motion: xr.Dataset,
    torque: float,
    allowed: float,
    variation: Mapping[str, float],
    push: FloatArray,
) -> list[Judgement]:
    """Mean moments of the pinion, and mean forces of each gear off the line of action.

    With the mean forces ``push`` (6,) of the teeth beside normal load and friction, pinion's moment first.
    """
    p, (k_p, k_g) = m.parameters, m.bearing_stiffness
    force = motion["friction_force"].to_numpy()
    moment = (force * motion["position"].to_numpy()).sum(axis=0)
    total, load = force.sum(axis=0), torque / p[kn.RADIUS_P]
    along = load + (push[0] - moment.mean()) / p[kn.RADIUS_P]
    values = {
        "x_p": -k_p[0] * _mean(motion, "x_p") - along + push[2],
        "x_g": k_g[0] * _mean(motion, "x_g") - along - push[3],
        "y_p": k_p[1] * _mean(motion, "y_p") - total.mean() - push[4],
        "y_g": -k_g[1] * _mean(motion, "y_g") - total.mean() + push[5],
    }
    stiffness = {"x_p": k_p[0], "x_g": k_g[0], "y_p": k_p[1], "y_g": k_g[1]}
    samples = force.shape[1]
    sampled = {
        "x": variation["moment"] / samples / p[kn.RADIUS_P] / load,
        "y": variation["force"] / samples / load,
    }
    return [
        Judgement(
            f"nature: mean bearing load {axis}, {name}",
            abs(float(value)) / load,
            sampled[axis[0]] + _missed(motion, axis) * stiffness[axis] / load + allowed + 1e-6,
            "T_p/r_bp less the mean moment of friction, or the mean friction; limit: what even times can "
            "miss of a history that jumps, its variation in the lumped model over their number, and of the "
            "displacement" + (", and the shift of the contact, by which the levers move" if allowed else ""),
        )
        for axis, value in values.items()
    ]


def _mean(motion: xr.Dataset, name: str) -> float:
    return float(motion[name].to_numpy().mean())


def _missed(motion: xr.Dataset, name: str) -> float:
    """What even times can miss of the mean of a displacement: step^2/8 times the variation of its rate."""
    rate, time = motion[f"{name}_dot"].to_numpy(), motion["time"].to_numpy()
    step = float(time[1] - time[0])
    return step * float(np.abs(np.diff(rate, append=rate[:1])).sum()) / (8.0 * rate.size)


def _variation(motion: PeriodicSolution) -> dict[str, float]:
    """Total variation over the cycle of the moment of friction about the pinion and of its sum.

    The mean of N even samples of a periodic history is off by no more than its variation over N. The motion
    is given on both sides of every jump, also of those that lie between two samples.
    """
    values = motion.values
    force = values["friction_force"]
    histories = {"moment": (force * values["position"]).sum(axis=0), "force": force.sum(axis=0)}
    return {name: _varied(one) for name, one in histories.items()}


def _varied(history: FloatArray) -> float:
    return float(np.abs(np.diff(history, append=history[:1])).sum())


def _first_law(name: str, powers: Mapping[str, float]) -> list[Judgement]:
    efficiency = powers["braking"] / powers["driving"]
    outside = max(efficiency - 1.0, 0.0 if efficiency > 0.0 else 1.0 - efficiency, 0.0)
    return [
        Judgement(
            f"nature: first law, {name}",
            residual(powers),
            _INTEGRATION[name],
            "driving power less brake, friction, bearings, damping of the teeth and the work of the change "
            "of stiffness and profile, over the driving power; limit: the error of the integration",
        ),
        Judgement(
            f"nature: efficiency, {name}",
            outside,
            _INTEGRATION[name],
            f"how far the efficiency, {efficiency:.6f}, lies outside (0, 1]; the error of the integration",
        ),
    ]


def _power_by_power(
    powers: Mapping[str, Mapping[str, float]], most: Mapping[str, float], shift: float, *, paid: bool
) -> list[Judgement]:
    own, found = powers["lumped"], []
    for name, other in powers.items():
        if name == "lumped":
            continue
        exact = name == "exact"
        expected = paid_by_the_brake(own) if exact and paid else own
        turned = sum(abs(expected[power]) for power in LOSSES) / own["driving"]
        for power, text in POWERS.items():
            limit, reason = _INTEGRATION[name], "the same equations: only integration error may remain"
            if exact and paid and power == "mesh_stiffness":
                reason = "what a contact with an energy stores it returns: only integration error may remain"
            elif exact:
                counted = [lost for lost in LOSSES if lost == power or power not in most]
                change = sum(most[lost] for lost in counted if expected[lost])
                limit += change + shift * turned
                reason = (
                    "limit: the most that finite motions can change to first order, and the shift of "
                    "the contact as share of all losses"
                )
            found.append(
                Judgement(
                    f"nature: power {power}, {name}",
                    abs(other[power] - expected[power]) / own["driving"],
                    limit,
                    f"power {text} of both models, difference over the driving power; {reason}",
                )
            )
    return found
