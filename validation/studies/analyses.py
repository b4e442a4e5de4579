"""The analyses of a study: results of a case and their units. One registry has all analyses."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

import numpy as np
import xarray as xr
from pydantic import Field, model_validator

from floquet.gear.axes import GearVariation
from lumped import GearPair
from lumped.errors import FieldProblem, ParameterError
from lumped.fields.section import Section
from lumped.fields.units import Quantity
from lumped.model.results import cycle_peak_to_peak, load_range
from lumped.model.steady_state import steady_state
from validation.prediction.motion import QUANTITIES, Motion, predict

AnalysisName = Literal["geometry", "lumped", "predict", "multibody", "floquet"]
Values = dict[str, float]
Labels = Mapping[str, tuple[str, str]]
_VERDICT = {"neutral": 2.0, "stable": 1.0, "undecided": 0.0, "unstable": -1.0}


class LinearMotion(Warning):
    """The linear motion stands in for the motion with unilateral contact, which does not exist."""


class Settings(Section):
    """Numerical settings of the analyses. An analysis reads only the settings that its description names."""

    samples_per_cycle: Annotated[int, Field(ge=8, le=65536, strict=True)] = Field(
        128, description="output times per mesh cycle (lumped, multibody)"
    )
    cycles: Annotated[int, Field(ge=2, le=100_000, strict=True)] = Field(
        20, description="mesh cycles simulated (multibody)"
    )
    kept_cycles: Annotated[int, Field(ge=1, le=100_000, strict=True)] = Field(
        1, description="last mesh cycles that the outputs are taken from (multibody)"
    )
    fidelity: Literal["linear", "exact"] = Field("exact", description="contact kinematics (multibody)")
    supports: Literal["springs", "shafts"] | None = Field(
        None, description="what holds the gears; default the shafts of a pair that has them"
    )
    rtol: Annotated[float | None, Quantity("1", at_least=1e-13, at_most=1e-2, optional=True)] = Field(
        None, description="relative tolerance (multibody, floquet); default that of the analysis"
    )

    @model_validator(mode="after")
    def _kept(self) -> Self:
        if self.kept_cycles > self.cycles:
            problem = FieldProblem(
                "kept_cycles", str(self.kept_cycles), f"<= cycles = {self.cycles}", "Lower it."
            )
            raise ParameterError([problem])
        return self


@dataclass(frozen=True)
class Analysis:
    """An analysis of a varied pair.

    Attributes
    ----------
    compute : function from the varied pair and the settings to the results
    outputs : result -> (unit, plain name)
    own_teeth : whether the teeth are those of the pair as given; else all teeth are alike
    """

    compute: Callable[[GearVariation, Settings], Values]
    outputs: Labels
    own_teeth: bool = False


_MOTIONS = {
    "dte": "transmission error",
    "x_p": "pinion displacement along the line of action",
    "x_g": "gear displacement along the line of action",
    "y_p": "pinion displacement off the line of action",
    "y_g": "gear displacement off the line of action",
}
_MOTION: Labels = {
    f"{name}_{kind}": ("m", f"{text}, {words}")
    for name, text in _MOTIONS.items()
    for kind, words in (("peak_to_peak", "peak to peak"), ("rms", "root mean square about its mean"))
} | {
    "normal_load_max": ("N", "largest normal load of a tooth pair in contact"),
    "normal_load_min": ("N", "smallest normal load of a tooth pair in contact; negative: the teeth separate"),
    "friction_force_peak_to_peak": ("N", "friction force of all tooth pairs, peak to peak"),
    "friction_power_mean": ("W", "mean friction power of all tooth pairs"),
}

_GEOMETRY: Labels = {
    "contact_ratio": ("1", "contact ratio"),
    "mesh_frequency": ("Hz", "mesh frequency"),
    "pitch_line_velocity": ("m/s", "pitch line velocity"),
    "operating_pressure_angle": ("rad", "operating pressure angle"),
    "centre_distance": ("m", "centre distance"),
    "normal_backlash": ("m", "normal backlash"),
    "base_pitch": ("m", "base pitch"),
    "L_XA": ("m", "distance from X to the start of contact"),
    "L_XD": ("m", "distance from X to the end of contact"),
    "L_XY": ("m", "length of the line of action between the base circles"),
}
_LUMPED: Labels = {
    **_MOTION,
    "mesh_efficiency": ("1", "mesh efficiency"),
    "brake_torque": ("N*m", "brake torque that holds the mean speed"),
    "error_estimate": ("1", "estimate of the largest relative error of the transmission error"),
}
_PREDICT: Labels = {
    **QUANTITIES,
    "power_loss": ("W", "mean power lost"),
    "contact_lost": ("1", "1: the mesh force reaches zero in the motion, 0: it does not"),
    "unstable": ("1", "1: the motion does not return after a small disturbance, 0: it does"),
    "linear": ("1", "1: the linear motion stands in, in which teeth may pull, 0: teeth push only"),
}
_FLOQUET: Labels = {
    "spectral_radius": ("1", "largest modulus of the multipliers"),
    "spectral_radius_error": ("1", "bound on the error of the largest modulus"),
    "verdict": ("1", "2 neutral, 1 stable, 0 undecided within the error, -1 unstable"),
    "liouville_residual": ("1", "mismatch of the determinant with Liouville's formula"),
}


def _geometry(variation: GearVariation, settings: Settings) -> Values:
    g = variation.pair.geometry
    return {name: float(getattr(g, name)) for name in _GEOMETRY}


def _lumped(variation: GearVariation, settings: Settings) -> Values:
    samples = settings.samples_per_cycle
    assert variation.supports != "rigid"  # a study has supports of the file
    run = steady_state(variation.pair, samples_per_cycle=samples, supports=variation.supports)
    return _motion(variation.pair, run) | {
        "mesh_efficiency": run.attrs["mesh_efficiency"],
        "brake_torque": run.attrs["brake_torque"],
        "error_estimate": run.attrs["error_estimate"],
        **{f"{name}_peak_to_peak": run.attrs[f"{name}_peak_to_peak"] for name in _MOTIONS},
    }


def _predict(variation: GearVariation, settings: Settings) -> Values:
    assert variation.supports != "rigid"  # a study has supports of the file
    prediction = predict(variation.pair, supports=variation.supports)
    linear = prediction.motion is Motion.LINEAR
    if linear:
        warnings.warn(prediction.reason, LinearMotion, stacklevel=1)
    return prediction.numbers | {
        "power_loss": prediction.loss,
        "contact_lost": float(prediction.contact_lost),
        "unstable": float(not prediction.stable),
        "linear": float(linear),
    }


def _multibody(variation: GearVariation, settings: Settings) -> Values:
    from multibody import simulate

    samples = settings.samples_per_cycle
    assert variation.supports != "rigid"  # a study has supports of the file
    tolerance: dict[str, Any] = {} if settings.rtol is None else {"rtol": settings.rtol}
    run = simulate(
        variation.pair,
        settings.cycles,
        fidelity=settings.fidelity,
        samples_per_cycle=samples,
        initial="periodic",
        supports=variation.supports,
        **tolerance,
    )
    # The grid ends on the last cycle's end, which is the first sample of a cycle that is not there.
    first = -1 - settings.kept_cycles * samples
    last_cycles = run.isel(time=slice(first, None))
    peaks = {f"{name}_peak_to_peak": cycle_peak_to_peak(last_cycles, name) for name in _MOTIONS}
    return _motion(variation.pair, run.isel(time=slice(first, -1))) | peaks


def _floquet(variation: GearVariation, settings: Settings) -> Values:
    from floquet.gear.multipliers import gear_pair_multipliers

    tolerance: dict[str, Any] = {} if settings.rtol is None else {"rtol": settings.rtol}
    multipliers = gear_pair_multipliers(variation, **tolerance)
    return {
        "spectral_radius": multipliers.spectral_radius,
        "spectral_radius_error": multipliers.error,
        "verdict": _VERDICT[multipliers.verdict],
        "liouville_residual": multipliers.liouville_residual,
    }


def _motion(pair: GearPair, run: xr.Dataset) -> Values:
    """Extremes and means of a motion over whole mesh cycles, without the peaks to peak of displacements."""
    values: Values = {}
    for name in _MOTIONS:
        values[f"{name}_rms"] = float(np.std(run[name].to_numpy()))
    load = run["normal_load"].to_numpy()
    contact = run["contact"].to_numpy()
    values["normal_load_max"], values["normal_load_min"] = load_range(pair, load, contact)
    values["friction_force_peak_to_peak"] = float(np.ptp(run["friction_force"].to_numpy().sum(axis=0)))
    values["friction_power_mean"] = float(run["friction_power"].to_numpy().sum(axis=0).mean())
    return values


ANALYSES: dict[AnalysisName, Analysis] = {
    "geometry": Analysis(_geometry, _GEOMETRY),
    "lumped": Analysis(_lumped, _LUMPED, own_teeth=True),
    "predict": Analysis(_predict, _PREDICT, own_teeth=True),
    "multibody": Analysis(_multibody, _MOTION, own_teeth=True),
    "floquet": Analysis(_floquet, _FLOQUET),
}
