"""One case: the varied pair through one analysis to plain numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from floquet.gear.axes import GEAR_AXES, GearVariation
from lumped.model.solution import steady_state
from lumped.schema.pair import GearPair
from validation.studies.outputs import OUTPUTS, Analysis

if TYPE_CHECKING:
    from validation.studies.axes import AxisValue
    from validation.studies.schema import Settings, Study

Values = dict[str, float]
_LOADED = {"multibody": "multibody", "floquet": "floquet.gear.multipliers"}
_VERDICT = {"stable": 1.0, "undecided": 0.0, "unstable": -1.0}


@dataclass(frozen=True)
class Evaluator:
    """Everything a worker needs for a case, small enough to travel with every task.

    Attributes
    ----------
    pair : the pair that is varied
    fields : paths of each axis
    analysis, outputs, settings : as in the study
    """

    pair: GearPair
    fields: tuple[tuple[str, ...], ...]
    analysis: Analysis
    outputs: tuple[str, ...]
    settings: Settings

    @staticmethod
    def of(study: Study) -> Evaluator:
        """Return the evaluator of a study."""
        fields = tuple(axis.field for axis in study.axes)
        return Evaluator(study.gear_pair, fields, study.analysis, study.outputs, study.settings)

    def prepare(self) -> None:
        """Load what the analysis needs, so that the first case takes no longer than the others."""
        import_module(_LOADED.get(self.analysis, "lumped"))

    def variation(self, values: tuple[AxisValue, ...]) -> GearVariation:
        """Return the pair with the axes' values; the plain fields change at once, so they need only fit
        together.

        Raises
        ------
        ParameterError : a combination that cannot exist
        """
        changes: dict[str, AxisValue] = {}
        charted: list[tuple[str, float]] = []
        for paths, value in zip(self.fields, values, strict=True):
            for path in paths:
                if path in GEAR_AXES:
                    charted.append((path, float(value)))
                else:
                    changes[path] = value
        variation = GearVariation(self.pair.with_(dict(changes)) if changes else self.pair)
        for name, number in charted:
            variation = GEAR_AXES[name].apply(variation, number)
        return variation

    def __call__(self, values: tuple[AxisValue, ...]) -> tuple[float, ...]:
        """Outputs of one case, in the study's order.

        Raises
        ------
        ParameterError : a combination that cannot exist
        NumericalError : the analysis fails
        """
        result = ANALYSES[self.analysis](self.variation(values), self.settings)
        return tuple(float(result[name]) for name in self.outputs)


def _geometry(variation: GearVariation, settings: Settings) -> Values:
    g = variation.pair.geometry
    return {name: float(getattr(g, name)) for name in OUTPUTS["geometry"]}


def _lumped(variation: GearVariation, settings: Settings) -> Values:
    run = steady_state(variation.pair, samples_per_cycle=settings.samples_per_cycle)
    return _motion(run) | {
        "mesh_efficiency": run.attrs["mesh_efficiency"],
        "brake_torque": run.attrs["brake_torque"],
        "error_estimate": run.attrs["error_estimate"],
    }


def _multibody(variation: GearVariation, settings: Settings) -> Values:
    from multibody import simulate

    samples = settings.samples_per_cycle
    tolerance: dict[str, Any] = {} if settings.rtol is None else {"rtol": settings.rtol}
    run = simulate(
        variation.pair,
        settings.cycles,
        fidelity=settings.fidelity,
        samples_per_cycle=samples,
        initial="periodic",
        **tolerance,
    )
    # The grid ends on the last cycle's end, which is the first sample of a cycle that is not there.
    return _motion(run.isel(time=slice(-1 - settings.kept_cycles * samples, -1)))


def _floquet(variation: GearVariation, settings: Settings) -> Values:
    from floquet.gear.multipliers import gear_pair_multipliers

    tolerance: dict[str, Any] = {} if settings.rtol is None else {"rtol": settings.rtol}
    found = gear_pair_multipliers(variation, **tolerance)
    return {
        "spectral_radius": found.spectral_radius,
        "spectral_radius_error": found.error,
        "verdict": _VERDICT[found.verdict],
        "liouville_residual": found.liouville_residual,
    }


def _motion(run: xr.Dataset) -> Values:
    """Extremes and means of a motion over whole mesh cycles."""
    values: Values = {}
    for name in ("dte", "x_p", "x_g", "y_p", "y_g"):
        samples = run[name].to_numpy()
        values[f"{name}_peak_to_peak"] = float(np.ptp(samples))
        values[f"{name}_rms"] = float(np.std(samples))
    loads = run["normal_load"].to_numpy()[run["contact"].to_numpy() > 0]
    values["normal_load_max"], values["normal_load_min"] = float(loads.max()), float(loads.min())
    values["friction_force_peak_to_peak"] = float(np.ptp(run["friction_force"].to_numpy().sum(axis=0)))
    values["friction_power_mean"] = float(run["friction_power"].to_numpy().sum(axis=0).mean())
    return values


ANALYSES: Mapping[Analysis, Callable[[GearVariation, Settings], Values]] = {
    "geometry": _geometry,
    "lumped": _lumped,
    "multibody": _multibody,
    "floquet": _floquet,
}
