"""The quantities of the report as plain arrays, to tell how much a fault changes them."""

import dataclasses
from collections.abc import Mapping
from functools import partial

import numpy as np
import xarray as xr

import lumped
import multibody
from floquet import fast_multipliers, gear_block, gear_pair_multipliers
from floquet.gear.axes import operating_rpm
from lumped import GearPair
from lumped.errors import NumericalError, ParameterError
from lumped.losses import ohlendorf_of, quasi_static_losses
from lumped.model.averaged import modes
from lumped.path_of_contact import friction_profile
from lumped.quasi_static.contacts import mesh_elements
from lumped.stiffness import iso6336
from lumped.stiffness.energy import energy_curve
from lumped.typing import FloatArray
from validation.prediction.motion import predicted

#: Times per mesh cycle.
SAMPLES = 64
#: A change below this share of the largest value is none.
FELT = 0.01


def quantities(pair: GearPair) -> dict[str, FloatArray]:
    """Every group of numbers by name; a group that cannot be computed is left out."""
    values: dict[str, FloatArray] = {}
    for compute in (
        _path,
        _motion,
        _report,
        _stability,
        _on_shafts,
        partial(_multibody, "linear"),
        partial(_multibody, "exact"),
    ):
        with np.errstate(all="ignore"):
            try:
                values |= compute(pair)
            except (NumericalError, ParameterError, ArithmeticError, np.linalg.LinAlgError):
                continue
    return values


def change(before: Mapping[str, FloatArray], after: Mapping[str, FloatArray]) -> tuple[float, str]:
    """Return the largest relative change and the name of the quantity. Infinite if a quantity is missing.

    The change of a quantity is divided by the largest value of the quantity.
    """
    worst = (0.0, "")
    for name, old in before.items():
        new = after.get(name)
        if new is None or new.shape != old.shape:
            return float("inf"), name
        size = float(np.abs(old[np.isfinite(old)]).max(initial=0.0))
        finite = np.isfinite(new) & np.isfinite(old)
        difference = float(np.abs(np.where(finite, new, 0.0) - np.where(finite, old, 0.0)).max(initial=0.0))
        lost = bool((~np.isfinite(new) & np.isfinite(old)).any())
        part = float("inf") if lost else difference / size if size > 0.0 else 0.0
        worst = max(worst, (part, name))
    return worst


def _numbers(data: xr.Dataset, prefix: str) -> dict[str, FloatArray]:
    return {
        f"{prefix} {name}": values.to_numpy().astype(float)
        for name, values in data.data_vars.items()
        if values.dtype.kind in "fib"
    }


def _attributes(data: xr.Dataset, prefix: str, *names: str) -> dict[str, FloatArray]:
    return {f"{prefix} {name}": np.array([float(data.attrs[name])]) for name in names}


def _on_shafts(pair: GearPair) -> dict[str, FloatArray]:
    """Motion of both models on elastic shafts, where the pair has them."""
    if pair.shafts is None:
        return {}
    modal = lumped.steady_state(pair, supports="shafts", samples_per_cycle=SAMPLES)
    machine = multibody.simulate(
        pair, 1, fidelity="linear", initial="periodic", supports="shafts", samples_per_cycle=SAMPLES
    )
    return _numbers(modal, "lumped on shafts") | _numbers(machine, "multibody on shafts")


def _path(pair: GearPair) -> dict[str, FloatArray]:
    """Geometry, bodies, element laws, every friction law, film."""
    quantities: dict[str, FloatArray] = {}
    for record in (pair.geometry, lumped.bodies(pair)):
        quantities |= {name: np.array([value]) for name, value in dataclasses.asdict(record).items()}
    elements = mesh_elements(pair)
    g = pair.geometry
    places = np.linspace(g.L_XA, g.L_XD, 201)[1:-1]
    for name in ("stiffness", "damping", "friction", "error"):
        quantities[f"tooth pair {name}"] = getattr(elements, name)(places)
    profile = friction_profile(pair, points=101)
    grid = np.linspace(0.0, 1.0, 101)
    low = float(profile["xi"][0])
    high = float(profile["xi"][-1])
    for quantity, values in profile.data_vars.items():
        if "xi" in values.dims and values.dtype.kind == "f":
            rows = np.atleast_2d(values.to_numpy())
            relative_place = (profile["xi"].to_numpy() - low) / (high - low)
            quantities[f"path {quantity}"] = np.array([np.interp(grid, relative_place, row) for row in rows])
    quantities |= _numbers(friction_profile(pair, points=101)[["mean_mu"]], "path")
    for hertz in ("weber_banaschek", "linear"):
        quantities[f"path energy stiffness, {hertz}"] = energy_curve(pair, hertz)(
            np.linspace(low, high, 51)[1:-1]
        )
    return quantities | {"ISO 6336": np.array([iso6336.single_of(pair), iso6336.mean_of(pair)])}


def _motion(pair: GearPair) -> dict[str, FloatArray]:
    """Periodic motion and transient on springs, transmission error at rest."""
    motion = lumped.steady_state(pair, samples_per_cycle=SAMPLES, supports="springs")
    values = _numbers(motion, "motion") | _attributes(motion, "motion", "mesh_efficiency", "brake_torque")
    values["share of power lost"] = 1.0 - values["motion mesh_efficiency"]
    run = lumped.simulate(pair, 2, samples_per_cycle=SAMPLES, supports="springs")
    values |= _numbers(run[["dte", "x_p", "theta_g_dot"]], "transient")
    still = lumped.static_transmission_error(pair)
    return values | _numbers(still, "at rest")


def _report(pair: GearPair) -> dict[str, FloatArray]:
    """Arithmetic of the report."""
    prediction = predicted(pair)
    static = dataclasses.asdict(quasi_static_losses(pair))
    values = {
        "speed": np.array([operating_rpm(pair)]),
        "static load": np.array([prediction.static_force]),
        **{name: np.array([value]) for name, value in prediction.numbers.items()},
        "loss factor": np.array([ohlendorf_of(pair)]),
        "mesh orders": prediction.orders_of("dte"),
        "natural frequencies": np.array([mode.natural_frequency for mode in modes(pair)]),
        "resonant speeds": np.array([mode.resonant_speed for mode in modes(pair)]),
    }
    values["share of power lost, prediction"] = 1.0 - values["efficiency"]
    return values | {f"quasi-static {name}": np.array([value]) for name, value in static.items()}


def _stability(pair: GearPair) -> dict[str, FloatArray]:
    """Multipliers on springs by both routes, and the bound of the compiled one."""
    general = gear_pair_multipliers(pair, 1e-9, supports="springs")
    compiled = fast_multipliers(gear_block(pair, supports="springs"))
    return {
        "decay per cycle": 1.0 - np.sort(np.abs(general.multipliers)),
        "decay per cycle, compiled": 1.0 - np.sort(np.abs(compiled.multipliers[0])),
        "bound of the compiled multipliers": np.array([compiled.errors.max()]),
    }


def _multibody(fidelity: str, pair: GearPair) -> dict[str, FloatArray]:
    motion = multibody.steady_state(
        pair,
        fidelity=fidelity,  # type: ignore[arg-type]
        samples_per_cycle=SAMPLES,
        rtol=1e-8,
        supports="springs",
    )
    names = [
        "dte", "x_p", "y_p", "y_g", "normal_load", "friction_force", "sliding_velocity", "bearing_force_y_g",
    ]  # fmt: skip
    return _numbers(motion[names], f"multibody {fidelity}")
