"""What the interactive page shows, computed once: stability slices, response of every friction law."""

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
#: Factors on the bearing stiffness span what a change of bearing or housing does.
_FACTORS = (0.25, 4.0)
_LEAST_FRICTION_RANGE = 0.1


@dataclass(frozen=True)
class Sampling:
    """How finely the page samples: nodes of its charts, and speeds of the response."""

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

    ``own`` is the index of the pair's own value; ``chart`` has spectral_radius and verdict over (key,
    damping_ratio, speed_rpm); ``tongues`` the unstable regions of each value, the largest first.
    """

    key: str
    own: int
    chart: xr.Dataset
    tongues: tuple[tuple[LabelledRegion, ...], ...]


@dataclass(frozen=True, eq=False)
class PageResults:
    """Content of the page.

    Attributes
    ----------
    pair : the gear pair
    found : Floquet multipliers at the operating point
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
    found: GearPairMultipliers
    stability: dict[str, Slices]
    sweep: xr.Dataset
    own_law: int
    notes: tuple[str, ...]
    missing: dict[str, str]
    resonances: tuple[float, ...]

    def dataset(self) -> xr.Dataset:
        """Every number of the page; the charts carry ``_over_`` and their third parameter in their names."""
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
    """Compute the content of the page, of a pair without shafts."""
    tell: Progress = progress or (lambda fraction, stage="", /: None)
    try:
        found = modes(pair)
    except NumericalError:  # an overdamped mode has no natural frequency
        found = ()
    grid = chart_axes(pair, sampling.speeds, sampling.dampings)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)  # the page says it beside the law
        stability = {}
        for done, (key, make) in enumerate(SLICES.items()):
            tell(0.4 * done / len(SLICES), "stability over a third parameter")
            stability[key] = make(pair, grid, sampling.slices)
        tell(0.4, "response of every friction law")
        # Friction hardly moves a resonance: the speeds that resolve the pair's own law resolve every law.
        own = resolved_sweep(pair, speed_range(pair), most=sampling.sweep_speeds, samples_per_cycle=_SAMPLES)
        sweeps, missing = _law_sweeps(pair, own, lambda f: tell(0.4 + 0.6 * f, "response over speed"))
        notes = tuple("; ".join(map(str, law_range_violations(pair, law))) for law in sweeps)
        multipliers = gear_pair_multipliers(pair)
    laws = xr.DataArray(
        np.array(list(sweeps), dtype=object), dims="law", name="law", attrs={"long_name": "friction law"}
    )
    return PageResults(
        pair=pair,
        found=multipliers,
        stability=stability,
        sweep=xr.concat(list(sweeps.values()), laws),
        own_law=list(sweeps).index(pair.friction.law),
        notes=notes,
        missing=missing,
        resonances=tuple(mode.resonant_speed for mode in found),
    )


def _law_sweeps(
    pair: GearPair, own: xr.Dataset, tell: Callable[[float], None]
) -> tuple[dict[str, xr.Dataset], dict[str, str]]:
    """Response of every law that this pair admits, at the speeds of its own; why others are missing."""
    speeds = own["speed"].to_numpy()
    sweeps = {pair.friction.law: _response(pair, own)}
    missing = {}
    laws = [*LAWS, *([TABLE] if pair.friction.table is not None else [])]
    for done, law in enumerate(laws):
        if law not in sweeps:
            try:
                at = pair.with_({"friction.law": law})
                sweeps[law] = _response(at, lumped.speed_sweep(at, speeds, samples_per_cycle=_SAMPLES))
            except (ParameterError, NumericalError) as error:
                missing[law] = str(error)
        tell((done + 1) / len(laws))
    return {law: sweeps[law] for law in laws if law in sweeps}, missing


def _response(pair: GearPair, found: xr.Dataset) -> xr.Dataset:
    """What the page shows of a sweep of this pair."""
    g = pair.geometry
    static = pair.operating.pinion_torque / g.base_radius_pinion
    lowest = found["normal_load_min"].to_numpy()
    reversal = found["sliding_reversal"].to_numpy()
    lowest = lowest / static
    reversal = reversal / g.base_pitch
    own = {"lowest_load": lowest, "reversal": reversal, "validity": validity_state(lowest, reversal)}
    values = {name: own[name] if name in own else found[name].to_numpy() for name in _LABELS}
    return labelled_dataset(
        {name: ("speed", array, *_LABELS[name]) for name, array in values.items()},
        {"speed": (found["speed"].to_numpy(), "rpm", "pinion speed")},
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
    """Charts with the stiffness of all bearings multiplied by one factor; 1 is the pair itself."""
    values = with_point(np.geomspace(*_FACTORS, count), 1.0)
    ends = [(g, f"{line}_stiffness") for g in ("pinion", "gear") for line in ("loa", "oloa")]
    own = {f"bearings.{g}.{key}": getattr(getattr(pair.bearings, g), key) for g, key in ends}
    variants = [pair.with_({path: factor * k for path, k in own.items()}) for factor in values.tolist()]
    charts = [stability_chart(variant, grid, rtol=_RTOL) for variant in variants]
    attrs = {"units": "1", "long_name": "bearing stiffness factor"}
    axis = xr.DataArray(values, dims="bearing_factor", name="bearing_factor", attrs=attrs)
    tongues = [tuple(label_regions(v, c)) for v, c in zip(variants, charts, strict=True)]
    chart = xr.concat([chart[_VARIABLES] for chart in charts], axis)
    return Slices("bearing_factor", int(np.argmin(np.abs(values - 1.0))), _ordered(chart), tuple(tongues))


def _friction_slices(pair: GearPair, grid: Grid, count: int) -> Slices:
    """Charts with the friction law scaled to a mean coefficient that is the same at every speed."""
    name = "friction_coefficient"
    own = GEAR_AXES[name].own(pair)
    values = with_point(np.linspace(0.0, min(max(_LEAST_FRICTION_RANGE, 2.0 * own), 1.0), count), own)
    chart = stability_chart(pair, {**grid, name: values}, rtol=_RTOL)
    tongues = [tuple(label_regions(pair, chart.isel({name: [i]}))) for i in range(count)]
    chart[name].attrs.update(units="1", long_name=GEAR_AXES[name].long_name)
    return Slices(name, int(np.argmin(np.abs(values - own))), _ordered(chart[_VARIABLES]), tuple(tongues))


#: Third parameter -> how its charts are made; the first is shown first.
SLICES: dict[str, Callable[[GearPair, Grid, int], Slices]] = {
    "bearing_factor": _bearing_slices,
    "friction_coefficient": _friction_slices,
}

_VARIABLES = ["spectral_radius", "error", "verdict"]


def _ordered(chart: xr.Dataset) -> xr.Dataset:
    return chart.transpose(..., "damping_ratio", "speed_rpm")
