"""Errata of the equations of motion: the signs of equations 1, 2, 7 and 9, one at a time."""

from __future__ import annotations

from collections.abc import Callable
from operator import methodcaller

import numpy as np
import xarray as xr
from scipy.optimize import linear_sum_assignment

from lumped import GearPair
from lumped.labelling import labelled_dataset
from lumped.model.equations import PRINTED_EQUATIONS
from reproductions.he_cho_singh_2008.errata.response import Response, response, speed_drift
from reproductions.he_cho_singh_2008.errata.stated import stated
from reproductions.he_cho_singh_2008.records import Erratum, Evidence

#: Cycles of the free runs that show a drift of the mean speed.
DRIFT_CYCLES = 20
_SUM = "sum of the tooth forces on both bodies"
_DRIFT = f"drift of the mean speed in {DRIFT_CYCLES} mesh cycles under the repaired model's torques"


def sign_errata(pair: GearPair) -> tuple[tuple[Erratum, ...], xr.Dataset]:
    """Errata of equations 1, 2, 7 and 9, and the motions behind them.

    Parameters
    ----------
    pair : a gear pair with enough friction to show them

    Returns
    -------
    the errata, and dte, x_g, y_g [m] over variant ("repaired", "equation 1", ...) and phase (mesh cycles)
    """
    repaired = response(pair)
    steady = speed_drift(pair, cycles=DRIFT_CYCLES)
    variants = {number: response(pair, as_printed=(number,)) for number in PRINTED_EQUATIONS}
    errata = tuple(_erratum(pair, number, r, repaired, steady) for number, r in variants.items())
    cycles = [repaired.cycle, *(r.cycle for r in variants.values())]
    names = ["repaired", *(f"equation {number}" for number in variants)]
    samples = repaired.cycle.sizes["time"]
    texts = {"dte": "dynamic transmission error", "x_g": "LOA motion of the gear", "y_g": "its OLOA motion"}
    return errata, labelled_dataset(
        {
            name: (("variant", "phase"), np.array([c[name].to_numpy() for c in cycles]), "m", text)
            for name, text in texts.items()
        },
        {
            "variant": (names, "1", "equations"),
            "phase": (np.arange(samples) / samples, "1", "mesh cycles"),
        },
    )


def one_pair_efficiency(pair: GearPair, xi: float, mu: float, *, printed: bool) -> float:
    """T_g Omega_g/(T_p Omega_p) of one tooth pair at rest in the rotating frame, from equations 1 and 2.

    Equation 1 gives N = T_p/(r_bp + X_p mu) as repaired and T_p/(r_bp - X_p mu) as printed (recess, mu > 0);
    equation 2 gives T_g = (r_bg + X_g mu) N.

    Parameters
    ----------
    pair : a gear pair
    xi : position of the contact from X [m]
    mu : signed friction coefficient there
    printed : use the printed sign of equation 1
    """
    g = pair.geometry
    sign = -1.0 if printed else 1.0
    ratio = g.base_radius_pinion / g.base_radius_gear
    return (g.base_radius_gear + mu * (g.L_XY - xi)) / (g.base_radius_pinion + sign * mu * xi) * ratio


def _erratum(pair: GearPair, number: int, printed: Response, repaired: Response, steady: float) -> Erratum:
    drift = speed_drift(pair, as_printed=(number,), cycles=DRIFT_CYCLES)
    evidence = _rows(printed, repaired, drift, steady)
    if number == 7:
        evidence.append(_bearing_symbol(pair, repaired))
    created = 100 * printed.created_power
    numbers = {
        "printed": printed,
        "repaired": repaired,
        "created": created,
        "destroyed": -created,
        "drift": 100 * drift,
        "times": drift,
        "cycles": DRIFT_CYCLES,
        "dte": 100 * (printed.peak_to_peak("dte") / repaired.peak_to_peak("dte") - 1),
        "x_g": (printed.mean("x_g"), repaired.mean("x_g")),
        "relative": (_relative_motion(printed), _relative_motion(repaired)),
    }
    return stated(str(number), numbers | _recess(pair), evidence)


def _rows(printed: Response, repaired: Response, drift: float, steady: float) -> list[Evidence]:
    """Balances that a right equation keeps, then effects on the motion."""
    opposite = "0: Newton's third law"
    contact = "0: forces at one contact only pass on or dissipate power"
    rows: list[tuple[str, str, Callable[[Response], float], str]] = [
        (
            "power created by the tooth forces",
            "% of the driving power",
            lambda r: 100 * r.created_power,
            contact,
        ),
        (f"{_SUM}, along the LOA", "N", lambda r: r.third_law_x, opposite),
        (f"{_SUM}, off the LOA", "N", lambda r: r.third_law_y, opposite),
        ("mesh efficiency at steady mean speed", "1", lambda r: r.efficiency, "between 0 and 1"),
        (
            "brake torque that holds the mean speed",
            "N m",
            lambda r: r.brake_torque,
            "positive: the gear is driven",
        ),
        (_DRIFT, "% of the speed", lambda r: 100 * (drift if r is printed else steady), "0"),
        *(
            (f"peak to peak of {n}", "µm", methodcaller("peak_to_peak", n), "")
            for n in ("dte", "x_g", "y_p", "y_g")
        ),
        *((f"mean of {n}", "µm", methodcaller("mean", n), "") for n in ("dte", "x_g")),
        ("peak to peak of y_p - y_g", "µm", _relative_motion, ""),
        ("largest modulus of the Floquet multipliers", "1", lambda r: r.radius, ""),
    ]
    return [
        *(Evidence(name, unit, value(printed), value(repaired), must) for name, unit, value, must in rows),
        Evidence("largest change of a Floquet multiplier", "1", multiplier_change(printed, repaired), 0.0),
    ]


def multiplier_change(first: Response, second: Response) -> float:
    """Largest distance between partners of the two sets of multipliers, paired at least total distance."""
    cost = np.abs(first.multipliers[:, None] - second.multipliers[None, :])
    rows, columns = linear_sum_assignment(cost)
    return float(cost[rows, columns].max())


def _relative_motion(r: Response) -> float:
    return float(np.ptp(r.cycle["y_p"].to_numpy() - r.cycle["y_g"].to_numpy())) * 1e6


def _recess(pair: GearPair) -> dict[str, float]:
    """Efficiency of one pair late in recess, as printed and as repaired, and the place [mm]."""
    g = pair.geometry
    # 21 mm from X for the 28/28 pair, as far along the recess for any other.
    xi = g.L_XP + 0.7551 * (g.L_XD - g.L_XP)
    wrong, right = (one_pair_efficiency(pair, xi, 0.05, printed=printed) for printed in (True, False))
    return {"xi": 1e3 * xi, "recess_printed": wrong, "recess_repaired": right}


def _bearing_symbol(pair: GearPair, repaired: Response) -> Evidence:
    """The OLOA bearing in the LOA equation, where the two stiffnesses differ by a factor of 2."""
    b = pair.bearings.gear
    softer = pair.with_({"bearings.gear.loa_stiffness": 0.5 * b.loa_stiffness})
    unlike = response(softer)
    return Evidence(
        "peak to peak of x_g where K_gBx = K_gBy/2 (printed: K_gBy taken)",
        "µm",
        repaired.peak_to_peak("x_g"),
        unlike.peak_to_peak("x_g"),
    )
