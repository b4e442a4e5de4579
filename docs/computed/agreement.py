"""The lumped model against the multibody model, and the Floquet matrix against flow maps of both levels."""

from __future__ import annotations

from functools import cache

import numpy as np
import xarray as xr

import floquet
import lumped
import multibody
import validation
from computed.markdown import must_pass, table
from lumped import GearPair
from validation.cross_check.verdict import Verdict

_TORQUE = 56.5
_QUANTITIES = ("dte", "x_p", "y_p")


def smooth_pair() -> GearPair:
    """The 28/28 pair without relief, with constant friction and stiffness without jumps."""
    return lumped.load_gear_pair("nasa_28_28").with_(
        mesh__relief="ignored",
        friction__law="coulomb",
        friction__coefficient=0.05,
        mesh__stiffness={"model": "parabolic", "ramp_length": 3.0},
    )


def cross_check() -> str:
    """All agreements of the default pair without relief, with limits and reasons."""
    result = validation.crosscheck(lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored"))
    must_pass("cross-check", result.verdict is not Verdict.FAILS)
    rows = [(a.long_name, a.fidelity, a.difference, a.limit) for a in result.agreements]
    reasons = "\n".join(f"- {reason}" for reason in dict.fromkeys(a.reason for a in result.agreements))
    heading = f"Verdict: **{result.verdict}**, that is, {result.verdict.text}.\n\n"
    return (
        heading
        + table(("quantity", "level", "largest difference over peak to peak", "limit"), rows)
        + f"\nWhy these limits:\n\n{reasons}\n"
    )


@cache
def torque_series() -> xr.Dataset:
    """Largest differences of the two periodic motions over torque, and those of the monodromy matrices."""
    torques = _TORQUE / 2.0 ** np.arange(7)
    sizes = {name: np.empty(torques.size) for name in _QUANTITIES}
    matrix = np.empty(torques.size)
    for j, torque in enumerate(torques):
        pair = smooth_pair().with_(operating__pinion_torque=float(torque))
        run = multibody.steady_state(pair, samples_per_cycle=128, effects={"contact_loss": False})
        reference = lumped.steady_state(pair, samples_per_cycle=128)
        for name, values in sizes.items():
            values[j] = np.abs(run[name] - reference[name]).max()
        flow = multibody.monodromy(pair, effects={"contact_loss": False})
        matrix[j] = matrix_difference(pair, flow.matrix)
    variables = {name: ("torque", values) for name, values in sizes.items()}
    return xr.Dataset(variables | {"monodromy": ("torque", matrix)}, coords={"torque": torques})


def matrix_difference(pair: GearPair, matrix: np.ndarray) -> float:
    """Norm of the difference to the Floquet matrix over the norm; rates per radian of the mesh cycle."""
    system = floquet.gear_pair_system(pair, "elastic")
    reference = floquet.monodromy(system, 1e-11).matrix
    d = np.concatenate([np.ones(5), np.full(5, lumped.geometry(pair).mesh_period / (2.0 * np.pi))])
    a, b = (m * d[:, None] / d for m in (matrix, reference))
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))


def observed_order(values: xr.DataArray) -> float:
    """Slope over the logarithm of the torque."""
    return float(np.polyfit(np.log(values["torque"]), np.log(values), 1)[0])


def torque_orders() -> str:
    """Orders in torque of motions and matrix."""
    series = torque_series()
    rows = []
    for name, expected in (*((q, 2.0) for q in _QUANTITIES), ("monodromy", 1.0)):
        order = observed_order(series[name])
        must_pass(f"order in torque of {name}", abs(order - expected) < 0.1)
        unit, what = ("m", f"motion, `{name}`") if expected == 2.0 else ("1", "monodromy matrix, relative")
        rows.append((what, unit, float(series[name][0]), float(series[name][-1]), expected, order))
    first, last = (f"at {float(series['torque'][i]):.3g} N m" for i in (0, -1))
    return table(("largest difference of", "unit", first, last, "order by theory", "observed"), rows)


def monodromy() -> str:
    """Floquet's matrix against the flow map of perturbed multibody runs."""
    rows = []
    jumps = smooth_pair().with_(mesh__stiffness={"model": "rectangular"})
    for name, pair in (("stiffness with jumps", jumps), ("smooth stiffness", smooth_pair())):
        radius = floquet.gear_pair_multipliers(pair).spectral_radius
        for fidelity in ("linear", "exact"):
            flow = multibody.monodromy(pair, fidelity=fidelity, effects=_effects(fidelity))
            difference = matrix_difference(pair, flow.matrix)
            must_pass(f"monodromy, {name}, {fidelity}", difference < (1e-8 if fidelity == "linear" else 0.2))
            rows.append((name, fidelity, difference, radius, flow.spectral_radius))
    return table(
        ("pair", "level", "difference of the matrices", "spectral radius, Floquet", "multibody"), rows
    )


def _effects(fidelity: str) -> dict[str, bool] | None:
    return {"contact_loss": False} if fidelity == "exact" else None


FILES = {"cross_check.md": cross_check, "torque_orders.md": torque_orders, "monodromy.md": monodromy}
