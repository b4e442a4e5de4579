"""Content of the interactive page, computed once: stability slices and the response of every friction law."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr

import lumped
from floquet.gear.axes import GEAR_AXES, chart_axes, speed_range, with_point
from floquet.gear.chart import LabelledRegion, label_regions, stability_chart
from floquet.gear.multipliers import GearPairMultipliers, gear_pair_multipliers
from lumped import GearPair, LawRangeWarning, NumericalError, ParameterError
from lumped.friction import LAWS
from lumped.friction.table import TABLE
from lumped.labelling import labelled_dataset, provenance
from lumped.model.averaged import modes
from lumped.model.sweep import resolved_sweep
from lumped.path_of_contact import law_range_violations
from lumped.typing import FloatArray, Progress
from validation.validity.flags import STATES, validity_state

Grid = dict[str, FloatArray]

#: Accuracy of the monodromy matrices; the page shows six decimals.
_RTOL = 1e-7
#: Range of the factor on the bearing stiffness: possible effect of another bearing or housing.
_FACTORS = (0.25, 4.0)
_LEAST_FRICTION_RANGE = 0.1


@dataclass(frozen=True)
class Sampling:
    """Numbers of points: nodes of the charts, and speeds of the response."""

    speeds: int = 101
    dampings: int = 17
    slices: int = 7
    sweep_speeds: int = 80


#: Samples per mesh cycle of the response over speed.
_SAMPLES = 96
FINE = Sampling()


@dataclass(frozen=True, eq=False)
class Slices:
    """Stability charts over speed and damping at several values of a third parameter, ``key``.

    Attributes
    ----------
    key : name of the third parameter
    index_of_pair : index of the value that the pair has
    chart : spectral_radius and verdict over (key, damping_ratio, speed_rpm)
    tongues : unstable regions at each value, the largest region first
    """

    key: str
    index_of_pair: int
    chart: xr.Dataset
    tongues: tuple[tuple[LabelledRegion, ...], ...]


@dataclass(frozen=True, eq=False)
class PageResults:
    """Content of the page.

    Attributes
    ----------
    pair : the gear pair
    multipliers : Floquet multipliers at the operating point
    stability : third parameter -> its charts
    sweep : response over (law, speed): dte_peak_to_peak, y_p_peak_to_peak [m]; lowest_load over the static
        load; reversal over the base pitch; validity, index into ``validation.validity.flags.STATES``;
        spectral_radius, above 1 where the motion is unstable
    own_law : index of the pair's law in the sweep
    notes : for each law of the sweep, where it is used outside its range; empty where it is not
    missing : law -> why it is not in the sweep
    resonances : speeds at which the mesh frequency meets a natural frequency of the averaged pair [rpm]
    """

    pair: GearPair
    multipliers: GearPairMultipliers
    stability: dict[str, Slices]
    sweep: xr.Dataset
    own_law: int
    notes: tuple[str, ...]
    missing: dict[str, str]
    resonances: tuple[float, ...]

    def dataset(self) -> xr.Dataset:
        """Return every number of the page. Names of chart variables end in ``_over_`` and the parameter."""
        parts = [
            slices.chart.rename({name: f"{name}_over_{key}" for name in slices.chart.data_vars})
            for key, slices in self.stability.items()
        ]
        parts.append(self.sweep)
        merged = xr.merge(parts, join="exact", combine_attrs="override")
        merged.attrs = provenance(self.pair) | {
            "title": f"interactive page of {self.pair.name}",
            "supports": "springs",
        }
        return merged


def compute(pair: GearPair, sampling: Sampling = FINE, progress: Progress | None = None) -> PageResults:
    """Compute the content of the page for a pair on springs."""
    tell: Progress = progress or (lambda fraction, stage="", /: None)
    try:
        natural_modes = modes(pair)
    except NumericalError:  # an overdamped mode has no natural frequency
        natural_modes = ()
    grid = chart_axes(pair, sampling.speeds, sampling.dampings)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)  # the page says it beside the law
        stability = {}
        for done, (key, make) in enumerate(SLICES.items()):
            tell(0.4 * done / len(SLICES), "stability over a third parameter")
            stability[key] = make(pair, grid, sampling.slices)
        tell(0.4, "response of every friction law")
        # Friction hardly changes a resonance. Speeds that resolve the response with the law of the pair
        # resolve the response with every law.
        sweep_of_pair = resolved_sweep(
            pair, speed_range(pair), most=sampling.sweep_speeds, samples_per_cycle=_SAMPLES
        )
        sweeps, missing = _law_sweeps(
            pair, sweep_of_pair, lambda f: tell(0.4 + 0.6 * f, "response over speed")
        )
        notes = tuple("; ".join(map(str, law_range_violations(pair, law))) for law in sweeps)
        multipliers = gear_pair_multipliers(pair)
    laws = xr.DataArray(
        np.array(list(sweeps), dtype=object), dims="law", name="law", attrs={"long_name": "friction law"}
    )
    return PageResults(
        pair=pair,
        multipliers=multipliers,
        stability=stability,
        sweep=xr.concat(list(sweeps.values()), laws),
        own_law=list(sweeps).index(pair.friction.law),
        notes=notes,
        missing=missing,
        resonances=tuple(mode.resonant_speed for mode in natural_modes),
    )


def _law_sweeps(
    pair: GearPair, sweep_of_pair: xr.Dataset, tell: Callable[[float], None]
) -> tuple[dict[str, xr.Dataset], dict[str, str]]:
    """Compute the response with every friction law, at the speeds of ``sweep_of_pair``.

    Returns
    -------
    friction law -> response, for every law that the pair admits
    friction law -> reason why the law is missing
    """
    speeds = sweep_of_pair["speed"].to_numpy()
    sweeps = {pair.friction.law: _response(pair, sweep_of_pair)}
    missing = {}
    laws = [*LAWS, *([TABLE] if pair.friction.table is not None else [])]
    for done, law in enumerate(laws):
        if law not in sweeps:
            try:
                pair_with_law = pair.with_({"friction.law": law})
                sweeps[law] = _response(
                    pair_with_law, lumped.speed_sweep(pair_with_law, speeds, samples_per_cycle=_SAMPLES)
                )
            except (ParameterError, NumericalError) as error:
                missing[law] = str(error)
        tell((done + 1) / len(laws))
    return {law: sweeps[law] for law in laws if law in sweeps}, missing


def _response(pair: GearPair, sweep: xr.Dataset) -> xr.Dataset:
    """Return the variables of a speed sweep that the page shows."""
    g = pair.geometry
    static = pair.operating.pinion_torque / g.base_radius_pinion
    lowest = sweep["normal_load_min"].to_numpy()
    reversal = sweep["sliding_reversal"].to_numpy()
    lowest = lowest / static
    reversal = reversal / g.base_pitch
    ratios = {"lowest_load": lowest, "reversal": reversal, "validity": validity_state(lowest, reversal)}
    values = {name: ratios[name] if name in ratios else sweep[name].to_numpy() for name in _LABELS}
    return labelled_dataset(
        {name: ("speed", array, *_LABELS[name]) for name, array in values.items()},
        {"speed": (sweep["speed"].to_numpy(), "rpm", "pinion speed")},
    )


#: Variable of the sweep -> unit, plain name.
_LABELS = {
    "dte_peak_to_peak": ("m", "transmission error, peak to peak"),
    "y_p_peak_to_peak": ("m", "pinion vibration off the line of action, peak to peak"),
    "lowest_load": ("1", "smallest normal load of a pair in contact over the static load"),
    "reversal": ("1", "largest distance of reversed sliding from the pitch point over the base pitch"),
    "validity": ("1", "0 to 3: " + ", ".join(STATES)),
    "spectral_radius": ("1", "largest multiplier of the periodic motion, unstable above 1"),
}


def _bearing_slices(pair: GearPair, grid: Grid, count: int) -> Slices:
    """Compute charts with all bearing stiffnesses multiplied by one factor. Factor 1: the pair itself."""
    values = with_point(np.geomspace(*_FACTORS, count), 1.0)
    ends = [(g, f"{line}_stiffness") for g in ("pinion", "gear") for line in ("loa", "oloa")]
    stiffnesses = {f"bearings.{g}.{key}": getattr(getattr(pair.bearings, g), key) for g, key in ends}
    variants = [
        pair.with_({path: factor * k for path, k in stiffnesses.items()}) for factor in values.tolist()
    ]
    charts = [stability_chart(variant, grid, rtol=_RTOL) for variant in variants]
    attrs = {"units": "1", "long_name": "bearing stiffness factor"}
    axis = xr.DataArray(values, dims="bearing_factor", name="bearing_factor", attrs=attrs)
    tongues = [tuple(label_regions(v, c)) for v, c in zip(variants, charts, strict=True)]
    chart = xr.concat([chart[_VARIABLES] for chart in charts], axis)
    return Slices("bearing_factor", int(np.argmin(np.abs(values - 1.0))), _ordered(chart), tuple(tongues))


def _friction_slices(pair: GearPair, grid: Grid, count: int) -> Slices:
    """Compute charts with the friction law scaled to one mean coefficient at all speeds."""
    name = "friction_coefficient"
    value_of_pair = GEAR_AXES[name].own(pair)
    values = with_point(
        np.linspace(0.0, min(max(_LEAST_FRICTION_RANGE, 2.0 * value_of_pair), 1.0), count), value_of_pair
    )
    chart = stability_chart(pair, {**grid, name: values}, rtol=_RTOL)
    tongues = [tuple(label_regions(pair, chart.isel({name: [i]}))) for i in range(count)]
    chart[name].attrs.update(units="1", long_name=GEAR_AXES[name].long_name)
    return Slices(
        name, int(np.argmin(np.abs(values - value_of_pair))), _ordered(chart[_VARIABLES]), tuple(tongues)
    )


#: Third parameter -> how its charts are made; the first is shown first.
SLICES: dict[str, Callable[[GearPair, Grid, int], Slices]] = {
    "bearing_factor": _bearing_slices,
    "friction_coefficient": _friction_slices,
}

_VARIABLES = ["spectral_radius", "error", "verdict"]


def _ordered(chart: xr.Dataset) -> xr.Dataset:
    return chart.transpose(..., "damping_ratio", "speed_rpm")
