"""Figure 2: friction coefficients of laws II and III in time, and mean coefficient of law V over speed."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from lumped import GearPair
from lumped.friction import mean_coefficient
from lumped.labelling import labelled_dataset
from lumped.path_of_contact import friction_path_function
from reproductions.he_cho_singh_2008.operating_points import (
    CALIBRATIONS,
    FIGURE_2A,
    SWITCH_SPEED,
    TORQUE_2B,
    mean_of_law,
    second_pair,
)
from reproductions.he_cho_singh_2008.records import FigureRecord, Number

_POINTS = 801
_SPEEDS = np.concatenate(
    [np.arange(250.0, 2200.0, 150.0), np.arange(2200.0, 3001.0, 20.0), np.arange(3150.0, 6001.0, 150.0)]
)


def friction_in_time(pair: GearPair) -> xr.Dataset:
    """Figure 2a: mu of laws II and III of one tooth pair from A to D, for both gear pairs.

    Parameters
    ----------
    pair : the first gear pair; the second one takes over its oil, roughness and law parameters

    Returns
    -------
    Dataset over gears, law and point: mu, time [s], cycles (mesh cycles since A), denser around the pitch
    point; over gears: contact_ratio, pitch (mesh cycles from A to P), mean_mu (gears, law)
    """
    rows = []
    both = (pair, second_pair(pair))
    for pair_at_point in map(FIGURE_2A.of, both):
        g = pair_at_point.geometry
        near = np.geomspace(5e-9, 1e-3, 80)
        xi = np.linspace(g.L_XA, np.nextafter(g.L_XD, 0.0), _POINTS)  # a path function is zero from D on
        xi = np.sort(np.concatenate([xi, g.L_XP - near, g.L_XP + near]))
        laws = [friction_path_function(pair_at_point, law=law) for law in ("benedict_kelley", "xu_kahraman")]
        cycles = (xi - g.L_XA) / g.base_pitch
        means = [mean_coefficient(law) for law in laws]
        to_pitch = (g.L_XP - g.L_XA) / g.base_pitch
        mu = [law(xi) for law in laws]
        rows.append((mu, means, cycles * g.mesh_period, cycles, g.contact_ratio, to_pitch))
    all_mu, mean_mu, time, since_a, ratio, pitch = map(np.array, zip(*rows, strict=True))
    return labelled_dataset(
        {
            "mu": (("gears", "law", "point"), all_mu, "1", "friction coefficient"),
            "mean_mu": (("gears", "law"), mean_mu, "1", "mean of |mu| over the path of contact"),
            "time": (("gears", "point"), time, "s", "time since A"),
            "cycles": (("gears", "point"), since_a, "1", "mesh cycles since A"),
            "contact_ratio": ("gears", ratio, "1", "contact ratio"),
            "pitch": ("gears", pitch, "1", "mesh cycles from A to P"),
        },
        {
            "gears": ([f"{p.pinion.teeth}/{p.gear.teeth}" for p in both], "1", "teeth of pinion and gear"),
            "law": (["II", "III"], "1", "friction law"),
        },
    )


def mean_over_speed(pair: GearPair) -> xr.Dataset:
    """Figure 2b: mean of |mu| of laws II, III and V over pinion speed, for the calibrations of the regime
    switch.

    Returns
    -------
    Dataset over calibration, law and speed [rpm]: mean_mu; over calibration: viscosity [mPa s] and composite
    roughness [um]
    """
    laws = {"II": "benedict_kelley", "III": "xu_kahraman", "V": "composite"}
    table = np.empty((len(CALIBRATIONS), len(laws), _SPEEDS.size))
    for i, (viscosity, roughness) in enumerate(CALIBRATIONS):
        oil = pair.with_(
            {
                "lubricant": {"viscosity": viscosity},
                "friction.composite_roughness": roughness,
                # Two flanks alike: S is the roughness of each.
                "pinion.roughness": roughness / math.sqrt(2.0),
                "gear.roughness": roughness / math.sqrt(2.0),
                "operating.pinion_torque": TORQUE_2B,
            }
        )
        for k, speed in enumerate(_SPEEDS):
            pair_at_speed = oil.with_({"operating.pinion_speed": float(speed)})
            for j, law in enumerate(laws.values()):
                table[i, j, k] = mean_of_law(pair_at_speed, law)
    return labelled_dataset(
        {
            "mean_mu": (("calibration", "law", "speed"), table, "1", "mean of |mu| over the path of contact"),
            "viscosity": ("calibration", [c[0] for c in CALIBRATIONS], "mPa s", "viscosity"),
            "composite_roughness": ("calibration", [c[1] for c in CALIBRATIONS], "um", "composite roughness"),
        },
        {
            "law": (list(laws), "1", "friction law"),
            "speed": (_SPEEDS, "rpm", "pinion speed"),
            "calibration": ([f"{v:g} mPa s, {r:g} µm" for v, r in CALIBRATIONS], "1", "oil and roughness"),
        },
    )


def regime_switch(mean: xr.DataArray, ii: xr.DataArray, iii: xr.DataArray) -> tuple[float, float, float]:
    """Speed [rpm], relative width and drop of the change from law II to law III in the mean of law V.

    With the share s = (mean_V - mean_III)/(mean_II - mean_III), 1 below and 0 above the change: the highest
    speed with s = 1/2, the distance between the highest speeds with s = 0.9 and s = 0.1 over it, and
    mean_II/mean_III there. NaN where the change is not within the speeds.
    """
    speed = mean["speed"].to_numpy()
    share = ((mean - iii) / (ii - iii)).to_numpy()

    def last(level: float) -> float:
        above = np.flatnonzero(share >= level)
        if above.size == 0 or above[-1] == share.size - 1:
            return float("nan")
        k = int(above[-1])
        part = (share[k] - level) / (share[k] - share[k + 1])
        return float(speed[k] + part * (speed[k + 1] - speed[k]))

    middle = last(0.5)
    if not np.isfinite(middle):
        return (float("nan"),) * 3
    ratio = float(ii.interp(speed=middle) / iii.interp(speed=middle))
    return middle, (last(0.1) - last(0.9)) / middle, ratio


def figure2(pair: GearPair) -> FigureRecord:
    """Figure 2 with its data and numbers."""
    a = friction_in_time(pair)
    b = mean_over_speed(pair)
    numbers: dict[str, Number] = {}
    for gears in a["gears"].to_numpy():
        means = a["mean_mu"].sel(gears=gears)
        numbers[f"{gears}: mean of II"] = Number(float(means.sel(law="II")))
        numbers[f"{gears}: mean of III"] = Number(float(means.sel(law="III")))
        numbers[f"{gears}: II over III"] = Number(float(means.sel(law="II") / means.sel(law="III")))
    for c in b["calibration"].to_numpy():
        m = b["mean_mu"].sel(calibration=c)
        speed, width, ratio = regime_switch(m.sel(law="V"), m.sel(law="II"), m.sel(law="III"))
        numbers[f"{c}: switch at"] = Number(speed, "rpm")
        numbers[f"{c}: width of the switch"] = Number(100 * width, "% of the speed")
        numbers[f"{c}: drop of the mean"] = Number(ratio, "times")
    return FigureRecord(
        number="2",
        title="Friction coefficients in time, and mean coefficient over speed",
        text=(
            f"(a) mu of laws II and III from A to D at {FIGURE_2A.torque:g} N m and {FIGURE_2A.speed:g} rpm; "
            f"(b) mean of |mu| of the composite law V at {TORQUE_2B:g} N m. The place of the regime switch "
            f"near {SWITCH_SPEED:g} rpm is not a prediction: composite roughness and viscosity are "
            "calibrated to it, for two oils. That the switch is abrupt is. Law II grows without limit "
            "towards the pitch point; it is held constant within 10 nm of it, and at most at its bound."
        ),
        numbers=numbers,
        data={"friction_in_time": a, "mean_over_speed": b},
    )
