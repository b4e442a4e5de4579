"""Mistakes of the ninth set, as functions that change a drawing, a line, a model, a road or curves."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import scipy.interpolate
import scipy.signal

from benchmarks.foreign_models.drawing import Drawing, Line, Wheel, drawing_of, line_of_action
from benchmarks.foreign_models.integrators import linear_form
from benchmarks.foreign_models.kernels import run_fixed
from benchmarks.foreign_models.model import Model, table_of
from benchmarks.foreign_models.ninth_runs import at_rest
from benchmarks.foreign_models.recipe import Curves

#: Rz over Ra of ground flanks.
RZ_OVER_RA = 6.0
#: Viscosity of the compressor's oil at 40 degrees Celsius [Pa s]; at its temperature it is 0.012.
COLD_OIL = 0.055
#: Newmark's gamma of the user who likes quiet curves; beta follows from it.
GAMMA = 0.9
#: Mesh cycles before a record by Newmark's method.
SETTLED = 80


def _both(drawing: Drawing, change: Callable[[Wheel], Wheel]) -> Drawing:
    return replace(drawing, pinion=change(drawing.pinion), gear=change(drawing.gear))


def _file(drawing: Drawing, section: str, **values: Any) -> Drawing:
    """The drawing of a file with other numbers in a section."""
    pair = copy.deepcopy(dict(drawing.parameters))
    pair[section] = pair[section] | values
    return drawing_of(pair)


def wider_width(drawing: Drawing) -> Drawing:
    widths = drawing.pinion.width, drawing.gear.width
    return replace(drawing, stiffness_factor=max(widths) / min(widths))


def gear_shift_reversed(drawing: Drawing) -> Drawing:
    return _file(drawing, "gear", profile_shift=-drawing.gear.shift)


def standard_tips(drawing: Drawing) -> Drawing:
    return _both(drawing, lambda one: replace(one, tip_radius=0.5 * drawing.module * (one.teeth + 2)))


def torque_of_gear(drawing: Drawing) -> Drawing:
    return replace(drawing, torque=drawing.torque * drawing.gear.teeth / drawing.pinion.teeth)


def flywheel_effect(model: Model) -> Model:
    return model.but(inertia_p=4.0 * model.inertia_p, inertia_g=4.0 * model.inertia_g)


def cold_oil(drawing: Drawing) -> Drawing:
    return replace(drawing, viscosity=COLD_OIL)


def rz_for_ra(drawing: Drawing) -> Drawing:
    return _both(drawing, lambda one: replace(one, roughness=RZ_OVER_RA * one.roughness))


def dry_steel(drawing: Drawing) -> Drawing:
    return replace(drawing, friction={"law": "coulomb", "coefficient": 0.15})


def one_bearing(drawing: Drawing) -> Drawing:
    return _both(
        drawing,
        lambda one: replace(
            one, loa_stiffness=0.5 * one.loa_stiffness, oloa_stiffness=0.5 * one.oloa_stiffness
        ),
    )


def bearing_slipped(drawing: Drawing) -> Drawing:
    gear = drawing.gear
    tenth = {"loa_stiffness": 0.1 * gear.loa_stiffness, "oloa_stiffness": 0.1 * gear.oloa_stiffness}
    return replace(drawing, gear=replace(gear, **tenth))


def bearings_turned(drawing: Drawing) -> Drawing:
    return _both(
        drawing,
        lambda one: replace(one, loa_stiffness=one.oloa_stiffness, oloa_stiffness=one.loa_stiffness),
    )


def relief_adds(model: Model) -> Model:
    gap = model.error
    return model.but(error=lambda xi: -gap(xi))


def standard_module(drawing: Drawing) -> Drawing:
    return _file(drawing, "basic_rack", module=3.0)


def single_for_mesh(drawing: Drawing) -> Drawing:
    return replace(drawing, stiffness_factor=1.0 / line_of_action(drawing).contact_ratio)


def without_correction(drawing: Drawing) -> Drawing:
    return replace(drawing, stiffness_factor=1.25)


def one_tooth(model: Model) -> Model:
    law = model.stiffness
    return model.but(stiffness=lambda xi: 2.0 * law(xi))


def no_moments(model: Model) -> Model:
    return model.but(signs={"moment_sign_p": 0.0, "moment_sign_g": 0.0})


def no_forces_across(model: Model) -> Model:
    return model.but(signs={"force_sign_yp": 0.0, "force_sign_yg": 0.0})


def first_pair_rubs(model: Model) -> Model:
    """A pair that comes into contact rubs only when it is alone."""
    line, law = model.line, model.friction
    alone = line.end - line.base_pitch
    return model.but(friction=lambda xi: np.where(xi < alone, 0.0, law(xi)))


def of_static_load(model: Model) -> Model:
    return model.but(others={"static_load": model.torque / model.line.base_radius_p})


def mass_of_pinion(model: Model) -> Model:
    ratio = 2.0 * model.drawing.mesh_damping
    return model.but(damping=lambda one, xi: ratio * np.sqrt(one.stiffness(xi) * one.mass_p))


def without_factor_2(model: Model) -> Model:
    law = model.damping
    return model.but(damping=lambda one, xi: 0.5 * law(one, xi))


def rayleigh(model: Model) -> Model:
    """Damping proportional to stiffness that has the ratio at the mesh frequency."""
    factor = 2.0 * model.drawing.mesh_damping * model.period / (2.0 * math.pi)
    return model.but(damping=lambda one, xi: factor * one.stiffness(xi))


def power_1_5(model: Model) -> Model:
    """Force of a pair with power 1.5; the stiffness is right at the mean compression."""
    mean = float(table_of(model)["stiffness"].sum(axis=0).mean())
    compression = model.torque / model.line.base_radius_p / mean
    return model.but(others={"hardening": 0.5, "reference_compression": compression})


def approach_of_rotations(model: Model) -> Model:
    return model.but(others={"x_in_approach": 0.0})


def only_rotations(curves: Curves, model: Model) -> Curves:
    return curves | {"dte": curves["dte"] - curves["x_p"] + curves["x_g"]}


def circular_pitch_line(line: Line) -> Line:
    """Neighbouring pairs a circular pitch apart, for a rack of 20 degrees."""
    return replace(line, base_pitch=line.base_pitch / math.cos(math.radians(20.0)))


def circular_pitch_model(model: Model) -> Model:
    return model.but(period_factor=math.cos(model.drawing.pressure_angle))


def damped_newmark(
    start: np.ndarray, times: np.ndarray, step: float, numbers: np.void, table: np.ndarray
) -> np.ndarray:
    """States by Newmark's method with numerical damping, on the samples; so many are in a mesh cycle."""
    count = round(float(numbers["period"]) / step)
    beta = 0.25 * (GAMMA + 0.5) ** 2
    matrices, sides = linear_form(np.arange(count) * step, numbers, table)
    springs, dampers, loads = matrices[:, 6:, :6], matrices[:, 6:, 6:], sides[:, 6:]
    place, speed = start[:6].copy(), start[6:].copy()
    pull = springs[0] @ place + dampers[0] @ speed + loads[0]
    states = np.empty((times.size, start.size))
    first = SETTLED * count
    for n in range(first + times.size):
        if n >= first:
            states[n - first] = np.r_[place, speed]
        then = (n + 1) % count
        place = place + step * speed + step**2 * (0.5 - beta) * pull
        speed = speed + step * (1.0 - GAMMA) * pull
        system = np.eye(6) - beta * step**2 * springs[then] - GAMMA * step * dampers[then]
        pull = np.linalg.solve(system, springs[then] @ place + dampers[then] @ speed + loads[then])
        place, speed = place + beta * step**2 * pull, speed + GAMMA * step * pull
    return states


def from_rest(
    start: np.ndarray, times: np.ndarray, step: float, numbers: np.void, table: np.ndarray
) -> np.ndarray:
    """States from gears at rest and without load, when the torques set in."""
    states: np.ndarray = run_fixed(0, at_rest(), 0.0, step, 4, times.size, numbers, table)
    return states


def thinned(curves: Curves, model: Model) -> Curves:
    """Every 64th sample, and a spline through them on the time steps that the export wants."""
    last = (curves["time"].size - 1) // 64 * 64 + 1
    time = curves["time"][:last]
    result = {}
    for name, values in curves.items():
        spline = scipy.interpolate.CubicSpline(time[::64], values[..., :last:64], axis=-1)
        result[name] = spline(time)
    return result | {"time": time}


def low_pass(curves: Curves, model: Model) -> Curves:
    """Butterworth filter of order 2 at twice the mesh frequency; its first 16 cycles are cut off."""
    time = curves["time"]
    rate = 1.0 / (time[1] - time[0])
    b, a = scipy.signal.butter(2, 2.0 / model.period, fs=rate)
    first = round(16.0 * model.period * rate)
    filtered = {}
    for name, values in curves.items():
        rest = scipy.signal.lfilter_zi(b, a) * values[..., :1]
        filtered[name] = scipy.signal.lfilter(b, a, values, axis=-1, zi=rest)[0][..., first:]
    return filtered | {"time": time[first:]}


def _scaled(factor: float, *begins: str) -> Callable[[Curves, Model], Curves]:
    def change(curves: Curves, model: Model) -> Curves:
        return curves | {name: factor * curves[name] for name in curves if name.startswith(begins)}

    return change


in_degrees = _scaled(180.0 / math.pi, "theta")
in_micrometres = _scaled(1e6, "dte", "x_", "y_")
on_housing = _scaled(-1.0, "bearing_force")


def of_centre_line(curves: Curves, model: Model) -> Curves:
    """Along and across the common tangent of the pitch circles in place of the line of action."""
    angle = math.atan(model.line.pitch_point / model.line.base_radius_p)
    turned = {}
    for name in ("{}_p", "{}_g", "bearing_force_{}_p", "bearing_force_{}_g"):
        x, y = curves[name.format("x")], curves[name.format("y")]
        turned[name.format("x")] = x * math.cos(angle) - y * math.sin(angle)
        turned[name.format("y")] = x * math.sin(angle) + y * math.cos(angle)
    return curves | turned


def gears_exchanged(curves: Curves, model: Model) -> Curves:
    other = {"p": "g", "g": "p"}
    names = [name for name in curves if name[-2:] in ("_p", "_g")]
    return curves | {name: curves[name[:-1] + other[name[-1]]] for name in names}


def without_means(curves: Curves, model: Model) -> Curves:
    return {name: values if name == "time" else values - values.mean() for name, values in curves.items()}


def load_of_one_pair(curves: Curves, model: Model) -> Curves:
    """Load of the pair that comes into contact at the start of the cycle."""
    return curves | {"mesh_force": curves["normal_load"][-1]}
