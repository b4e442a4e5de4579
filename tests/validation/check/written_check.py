"""Pages of checks, written and read again, and the models of somebody else whose checks they show."""

import dataclasses
import json
from functools import cache
from pathlib import Path

import numpy as np

import lumped
from tests.unlike_pairs import unlike_pair
from tests.validation.check.curves_of_motions import sampled
from tests.validation.reporting.written import Written
from validation.check.check import check
from validation.check.curves import Curves, SpeedColumn, ValuesOverSpeed
from validation.check.ladder import Alternative, Explanation, Ladder
from validation.reporting.check_page import write_check

#: From A, mesh cycles of the first sample of ``wrong_curves``.
PHASE = 0.37
CHANNELS = ("dte", "x_p", "y_g", "mesh_force")
#: A stated contact ratio that is 6 % off, and a base radius that is right.
CONTACT_RATIO_FACTOR = 1.06
STEPS = (
    Explanation(
        "stiffness", 0.85, 0.08, "A mesh stiffness 0.85 times ours",
        (Alternative("width", 0.85, 0.09, "A face width 0.85 times ours"),),
    ),
    Explanation("friction_law", "none", 0.013, "No friction"),
)  # fmt: skip
#: Speeds [rpm] of the values over speed, and their factors on ours.
SPEEDS = (700.0, 1100.0, 1900.0)
FACTORS = (1.0, 1.3, 1.02)


@cache
def pair():
    return unlike_pair("rack_25_degrees_always_pushing")


@cache
def softer():
    """The pair whose bearings are softer along the line of action, with more friction."""
    return pair().with_({"bearings.pinion.loa_stiffness": 1.7e8, "friction.maximum": 0.08})


@cache
def wrong_curves() -> Curves:
    curves = sampled(softer(), CHANNELS, phase=PHASE)
    g = pair().geometry
    statics = {
        "contact_ratio": np.asarray(CONTACT_RATIO_FACTOR * g.contact_ratio),
        "base_radius_pinion": np.asarray(g.base_radius_pinion),
    }
    return dataclasses.replace(curves, statics=statics, remarks=("A remark on the reading.",))


def model(parameters, refine=1):
    """A model that can be called: ours with a transmission error 1.2 times as large, x and forces right."""
    known = {name: parameters[name] for name in pair().to_mapping()}
    cycle = lumped.steady_state(lumped.load_gear_pair(known), contact="unilateral", samples_per_cycle=512)
    step = float(cycle["time"][1]) / refine
    every = np.arange(0.0, 5.0 * 512 * refine) / refine
    grid = np.arange(512)
    columns = {"dte [m]": 1.2 * cycle["dte"].to_numpy(), "x_p [m]": cycle["x_p"].to_numpy()}
    read = {name: np.interp(every % 512, grid, values, period=512) for name, values in columns.items()}
    return {"time [s]": np.arange(every.size) * step} | read


@cache
def checked(name: str):
    """A check of each kind: curves with statics and a ladder, a model, values over speed, right curves."""
    if name == "wrong":
        result = check(pair(), wrong_curves(), explain=False)
        assert result.problem is not None
        ladder = Ladder(result.problem.misfit.value, STEPS, result.problem.motion, 321, complete=False)
        return dataclasses.replace(result, ladder=ladder)
    if name == "model":
        return check(pair(), model, explain=False)
    if name == "over_speed":
        return check(pair(), values_over_speed())
    return check(pair(), sampled(pair(), CHANNELS, phase=PHASE))


@cache
def values_over_speed() -> ValuesOverSpeed:
    """Peaks to peak that are ours times ``FACTORS``, and a first order of x_p that is ours."""
    dte, x_p = [], []
    for rpm in SPEEDS:
        cycle = lumped.steady_state(pair().with_(speed=rpm), contact="unilateral")
        dte.append(float(np.ptp(cycle["dte"].to_numpy())))
        x_p.append(2.0 * abs(np.fft.rfft(cycle["x_p"].to_numpy())[1]) / cycle.sizes["time"])
    columns = (
        SpeedColumn("TE pp", "dte", "peak_to_peak", np.array(FACTORS) * dte),
        SpeedColumn("x order 1", "x_p", "order", np.array(x_p), 1.0),
    )
    return ValuesOverSpeed("run-up", np.array(SPEEDS) * np.pi / 30.0, columns)


def written_check(name: str, folder: Path) -> Written:
    """Write the page of a check into a new folder and read it."""
    result = checked(name)
    write_check(result, folder)
    document = json.loads((folder / "check.json").read_text(encoding="utf-8"))
    page = (folder / "index.html").read_text(encoding="utf-8")
    return Written(folder, result, document, page)
