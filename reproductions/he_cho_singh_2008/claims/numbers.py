"""The numbers behind the claims, each with the definition that the claims table states.

Everything here is a function of a gear pair with all its assumptions, or of runs of the four laws, so that
the same numbers can be had for any sample of the assumptions and for either model.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import xarray as xr

from lumped import GearPair, PathFunction
from lumped.friction import mean_coefficient
from lumped.model.steady import periodic_cycle
from lumped.path_of_contact import contact_path, friction_path_function
from lumped.typing import FloatArray
from reproductions.he_cho_singh_2008.operating_points import (
    FIGURE_2A,
    FIGURE_4,
    FIGURE_7,
    LAWS,
    TORQUE_2B,
    mean_of_law,
    second_pair,
)
from reproductions.he_cho_singh_2008.twins import mesh_orders, total

#: Half width of "at the pitch point" [mesh cycles].
AT_PITCH = 0.01
#: Distance from the pitch point at which one-sided limits are taken [m]; law IV changes over 1/Phi = 2e-5 m.
_ONE_SIDED = 1e-9
#: Power with which the film parameter grows with speed, equation 21.
_FILM_POWER = 0.69
_ORDERS = 10
_SAMPLES = 128  # of a mesh cycle


def measure(pair: GearPair) -> dict[str, float]:
    """All claim numbers of a pair, name -> value."""
    return (
        {"mean_ratio": mean_ratio(pair)}
        | at_pitch_point(pair)
        | regime_change(pair)
        | {f"jump_{law}": value for law, value in pitch_jumps(FIGURE_4.of(pair)).items()}
        | fig4_motions(pair)
        | fig7_motion(pair)
    )


def mean_ratio(pair: GearPair) -> float:
    """Mean |mu| of II over that of III at Fig. 2a's point, the smaller of the two gear pairs."""
    points = (FIGURE_2A.of(gears) for gears in (pair, second_pair(pair)))
    return min(
        mean_of_law(pair_at_point, "benedict_kelley") / mean_of_law(pair_at_point, "xu_kahraman")
        for pair_at_point in points
    )


def at_pitch_point(pair: GearPair) -> dict[str, float]:
    """Largest |mu| within ``AT_PITCH`` of P: law III over its mean, law II over its maximum elsewhere."""
    pair_at_point = FIGURE_2A.of(pair)
    g = pair_at_point.geometry
    near = g.L_XP + AT_PITCH * g.base_pitch * np.linspace(-1.0, 1.0, 401)
    path = np.linspace(g.L_XA, np.nextafter(g.L_XD, 0.0), 2001)
    outside = path[np.abs(path - g.L_XP) > AT_PITCH * g.base_pitch]
    ii, iii = (friction_path_function(pair_at_point, law=law) for law in ("benedict_kelley", "xu_kahraman"))
    return {
        "iii_at_pitch": float(np.abs(iii(near)).max()) / mean_coefficient(iii),
        "ii_at_pitch": float(np.abs(ii(near)).max()) / max(float(np.abs(ii(outside)).max()), 1e-12),
    }


def regime_change(pair: GearPair) -> dict[str, float]:
    """Speed [rpm], relative width and drop of mean |mu| of the change from law II to III at Fig. 2b's torque.

    Lambda grows with v_e^0.69 at every place of the path, so that the law changes at a different speed at
    each place. Speed: half of the path has changed. Width: from 10 % to 90 % of the path, over the speed.
    Drop: mean of II over mean of III.
    """
    reference = pair.with_({"operating.pinion_torque": TORQUE_2B, "operating.pinion_speed": 1000.0})
    path = contact_path(reference)
    xi = np.linspace(path.L_XA, path.L_XD, 2001)
    threshold = pair.friction.thresholds[1]
    speeds = 1000.0 * (threshold / path.film_parameter(xi)) ** (1.0 / _FILM_POWER)
    low, middle, high = (float(np.percentile(speeds, p)) for p in (10, 50, 90))
    pair_at_change = reference.with_({"operating.pinion_speed": min(max(middle, 1.0), 1.9e5)})
    drop = mean_of_law(pair_at_change, "benedict_kelley") / mean_of_law(pair_at_change, "xu_kahraman")
    return {"switch_speed": middle, "switch_width": (high - low) / middle, "switch_drop": drop}


def pitch_jumps(pair: GearPair) -> dict[str, float]:
    """Jump of mu at the pitch point over its peak to peak, per law, at Fig. 4's point."""
    g = pair.geometry
    path = np.linspace(g.L_XA, np.nextafter(g.L_XD, 0.0), 4001)
    sides = g.L_XP + _ONE_SIDED * np.array([-1.0, 1.0])
    jumps = {}
    for law in LAWS:
        mu: PathFunction = friction_path_function(pair, law=law)
        before, after = mu(sides)
        span = float(np.ptp(np.concatenate([mu(path), [before, after]])))
        jumps[law] = float(after - before) / span
    return jumps


def law_cycles(pair: GearPair) -> xr.Dataset:
    """Lumped periodic motion under laws I to IV, lighter than ``law_runs``.

    Returns
    -------
    Dataset over law, [pair,] phase (mesh cycles): dte, x_p, y_p, normal_load, friction_force, contact; over
    law: spectral_radius
    """
    runs = [periodic_cycle(pair.with_({"friction.law": law}), _SAMPLES) for law in LAWS]
    dims = {1: ("law", "phase"), 2: ("law", "pair", "phase")}
    variables = {}
    for name in ("dte", "x_p", "y_p", "normal_load", "friction_force", "contact"):
        values = np.array([run.values[name] for run in runs])
        variables[name] = (dims[values.ndim - 1], values)
    variables["spectral_radius"] = (("law",), np.array([run.spectral_radius for run in runs]))
    return xr.Dataset(variables, coords={"law": list(LAWS), "phase": np.arange(_SAMPLES) / _SAMPLES})


def load_spread(cycles: xr.Dataset) -> tuple[float, float]:
    """Spread of the total normal load between the laws over its mean: largest and rms over time."""
    load = total(cycles["normal_load"])
    spread = load.max("law") - load.min("law")
    mean = float(load.mean())
    return float(spread.max()) / mean, float(np.sqrt((spread**2).mean())) / mean


def motion_differences(cycles: xr.Dataset, name: str) -> tuple[float, float]:
    """Largest rms difference and mean absolute difference between two laws, over the mean peak to peak.

    The rms difference is of the worst of the six pairs of laws. The absolute difference is the mean over the
    six pairs.
    """
    values = cycles[name].transpose("law", "phase").to_numpy()
    span = float(np.ptp(values, axis=1).mean())
    differences = np.array([values[i] - values[j] for i, j in combinations(range(len(values)), 2)])
    worst = float(np.sqrt((differences**2).mean(axis=1)).max())
    return worst / span, float(np.abs(differences).mean()) / span


def spread_by_order(cycles: xr.Dataset, name: str) -> tuple[FloatArray, FloatArray]:
    """Spread of the amplitudes between the laws at mesh orders 1 to 10: absolute [m] and over the mean.

    An order with a mean amplitude below 2 % of the largest carries no motion: the relative spread is 0.
    """
    amplitude = mesh_orders(cycles[name], _ORDERS).transpose("law", "order").to_numpy()
    spread = np.ptp(amplitude, axis=0)
    mean = amplitude.mean(axis=0)
    relative = np.where(mean > 0.02 * mean.max(), spread / mean, 0.0)
    return np.asarray(spread, dtype=np.float64), np.asarray(relative, dtype=np.float64)


def largest_order(cycles: xr.Dataset, name: str, *, relative: bool = False) -> int:
    """Mesh order at which the laws differ most, see ``spread_by_order``."""
    return int(np.argmax(spread_by_order(cycles, name)[int(relative)])) + 1


def fig4_motions(pair: GearPair) -> dict[str, float]:
    """Differences between laws I to IV in the motions of Figs. 4 to 6, and numbers that judge these motions.

    radius_4: largest multiplier; min_load_4: smallest load of a pair in contact over the static load.
    """
    pair_at_point = FIGURE_4.of(pair)
    cycles = law_cycles(pair_at_point)
    static = pair_at_point.operating.pinion_torque / pair_at_point.geometry.base_radius_pinion
    numbers = {
        "radius_4": float(cycles["spectral_radius"].max()),
        "min_load_4": float(cycles["normal_load"].where(cycles["contact"] > 0).min()) / static,
    }
    numbers["load_spread"], numbers["load_spread_rms"] = load_spread(cycles)
    for name in ("x_p", "y_p", "dte"):
        numbers[f"rms_{name}"], numbers[f"mean_absolute_{name}"] = motion_differences(cycles, name)
        numbers[f"order_{name}"] = float(largest_order(cycles, name))
        numbers[f"relative_order_{name}"] = float(largest_order(cycles, name, relative=True))
    return numbers


def fig7_motion(pair: GearPair) -> dict[str, float]:
    """Law III at the points of Fig. 7: mean |mu| at both, and the motion at the faster one.

    Largest normal load and friction force of a tooth pair [N]; radius_7 and min_load_7 as in
    ``fig4_motions``.
    """
    slow, fast = (mean_of_law(point.of(pair), "xu_kahraman") for point in FIGURE_7)
    pair_at_point = FIGURE_7[1].of(pair).with_({"friction.law": "xu_kahraman"})
    run = periodic_cycle(pair_at_point, _SAMPLES)
    normal = run.values["normal_load"]
    friction = run.values["friction_force"]
    static = pair_at_point.operating.pinion_torque / pair_at_point.geometry.base_radius_pinion
    return {
        "mean_iii_slow": slow,
        "mean_iii_fast": fast,
        "peak_normal": float(normal.max()),
        "peak_friction": float(np.abs(friction).max()),
        "radius_7": run.spectral_radius,
        "min_load_7": float(normal[run.values["contact"] > 0].min()) / static,
    }
