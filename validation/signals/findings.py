"""Effects of teeth that differ, compared with the twin with like teeth. Report and command use these results.

Sources: docs/theory/teeth.md, "Motion", "Signals".
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import xarray as xr

import floquet
import lumped
from lumped.errors import refuse
from lumped.fields.units import to_stated
from lumped.labelling import labelled_dataset
from lumped.model.periodic_system import Supports, supports_of
from lumped.schema.pair import GearPair
from lumped.schema.tolerances import flank_tolerances
from lumped.schema.tooth_errors import tooth_errors
from lumped.typing import FloatArray
from validation.signals.averages import Gear, indicators, sidebands
from validation.signals.orders import order_spectrum

#: White noise of a sensor in an average signal, over the root mean square of the average of the healthy twin.
NOISE = 0.01
#: A sideband from this share of the amplitude of the mesh harmonic on counts as audible or measurable.
_SEEN = 0.01
GEARS: tuple[Gear, Gear] = ("pinion", "gear")


class TeethFindings:
    """Motion of a pair whose teeth differ, and motion of the twin with like teeth.

    A pair with like teeth is refused. ``supports``: supports of both motions, by default the shafts of a pair
    with shafts. ``motion``: motion of the pair, if it is computed already.
    """

    def __init__(
        self, pair: GearPair, supports: Supports | None = None, motion: xr.Dataset | None = None
    ) -> None:
        if pair.healthy is pair:
            action = (
                "Give [pinion.deviations], [pinion.mounting] or [[pinion.faults]]: spurcheck teeth --help."
            )
            raise refuse("pinion", "teeth that are alike", "teeth that differ", action)
        self.pair = pair
        self.supports = supports_of(pair, supports)
        if motion is None:
            motion = lumped.steady_state(pair, contact="unilateral", supports=self.supports)
        self.motion = motion
        samples = self.motion.sizes["time"] // self.period
        self.twin = lumped.steady_state(
            pair.healthy,
            contact=motion.attrs["contact"],
            supports=self.supports,
            samples_per_cycle=samples,
        )

    @property
    def period(self) -> int:
        """Mesh cycles after which the motion repeats."""
        return int(self.motion.attrs["period_cycles"])

    @property
    def mean_force(self) -> float:
        """Mean mesh force of the motion of the pair [N]."""
        return float(self.motion["normal_load"].sum("pair").mean())

    @staticmethod
    def tooth_load(result: xr.Dataset) -> float:
        """Largest load of one tooth pair of a motion over the mean mesh force of this motion [-]."""
        load = result["normal_load"]
        return float(load.max() / load.sum("pair").mean())

    @cached_property
    def contact_lost(self) -> tuple[tuple[int, int], ...]:
        """Teeth (pinion, gear) at which the total mesh force is zero; empty where contact is kept."""
        total = self.motion["normal_load"].sum("pair").to_numpy()
        samples_without_load = np.flatnonzero(total <= 0.0)
        teeth = (self.motion[f"{gear}_tooth"].isel(pair=0).to_numpy()[samples_without_load] for gear in GEARS)
        return tuple(sorted({(int(p), int(g)) for p, g in zip(*teeth, strict=True)}))

    @cached_property
    def largest_loads(self) -> FloatArray:
        """(z1, z2) largest load of each meeting pair [N]; NaN for teeth that never meet."""
        loads = np.full((self.pair.pinion.teeth, self.pair.gear.teeth), np.nan)
        teeth = (self.motion[f"{gear}_tooth"].to_numpy().ravel() - 1 for gear in GEARS)
        np.fmax.at(loads, tuple(teeth), self.motion["normal_load"].to_numpy().ravel())
        return np.where(loads > 0.0, loads, np.nan)

    @cached_property
    def rates(self) -> tuple[float, float]:
        """Growth of a perturbation in one mesh cycle, |multiplier|^(1/cycles): the pair, then the twin."""
        multipliers = floquet.revolution_multipliers(self.pair, supports=self.supports)
        return multipliers.rate, multipliers.healthy_rate

    def spectrum(self, gear: Gear, variable: str = "dte") -> xr.Dataset:
        """Amplitudes over the orders of a shaft, of the pair and of its twin."""
        amplitudes = order_spectrum(self.motion, gear, variable=variable)
        twin = order_spectrum(self.twin, gear, variable=variable)
        healthy = np.zeros(amplitudes.sizes["order"])
        healthy[:: self.period] = twin["amplitude"].to_numpy()[: healthy[:: self.period].size]
        words = "amplitude of the twin with like teeth"
        attributes = {"units": amplitudes["amplitude"].attrs["units"], "long_name": words}
        return amplitudes.assign(healthy=("order", healthy, attributes))

    def indicators(self, gear: Gear) -> xr.Dataset:
        """Condition indicators of the pinion's acceleration, with the noise of ``NOISE``."""
        quiet = indicators(self.motion, gear)["value"]
        floor = NOISE * float(quiet.sel(indicator="RMS", record="healthy twin"))
        return indicators(self.motion, gear, noise_floor=floor)

    @cached_property
    def sentence(self) -> str:
        """Effects of the teeth that a listener or a sensor notices, in one sentence."""
        parts = []
        for gear in GEARS:
            if not self._turns(gear):
                continue
            z = {"pinion": self.pair.pinion.teeth, "gear": self.pair.gear.teeth}[gear]
            ratio = sidebands(self.motion, gear)["ratio"].sel(mesh_order=1)
            ratio = ratio.where(ratio["sideband"] != 0, 0.0)
            largest_sideband = int(ratio["sideband"][int(np.argmax(ratio.to_numpy()))])
            share = float(ratio.max())
            hertz = self.pair.geometry.mesh_frequency / z
            size = (
                f"the largest is {100 * share:.2g} % of the mesh tone, at order {z + largest_sideband}"
                if share >= _SEEN
                else "all below 1 % of the mesh tone"
            )
            rms = self.indicators(gear)["value"].sel(indicator="RMS_residual")
            times = float(rms.sel(record="pair") / rms.sel(record="healthy twin"))
            parts.append(
                f"Sidebands at a spacing of {hertz:.3g} Hz ({gear}): {size}. "
                f"Residual signal: {times:.2g} times that of perfect teeth."
            )
        lost = self.contact_lost
        contact_words = f"Contact is lost at {len(lost)} meeting teeth." if lost else "Contact is kept."
        return " ".join([*(parts or ["Only the torque differs."]), contact_words])

    def _turns(self, gear: Gear) -> bool:
        return bool(getattr(self.pair, gear).has_own_teeth)


def deviations_table(pair: GearPair) -> xr.Dataset:
    """Index deviations of both gears, and the tolerance class of ISO 1328-1:2013.

    Returns
    -------
    xarray.Dataset over ``gear``: ``cumulative`` and ``pitch``, their range and largest step [m];
    ``eccentricity`` [m]; ``tolerance_class``, the least class whose F_p and f_p hold, 12 for none
    """
    rows = []
    for teeth in tooth_errors(pair):
        cumulative = float(np.ptp(teeth.index))
        pitch = float(np.abs(np.diff(teeth.index, prepend=teeth.index[-1])).max())
        # A gear that was drawn from a class has one deviation equal to the tolerance, but for rounding.
        sizes = (1.0 - 1e-9) * np.array([pitch, cumulative])
        tolerance_class = 1
        while tolerance_class < 12:
            limit = flank_tolerances(teeth.index.size, pair.basic_rack.module, tolerance_class)
            if (sizes <= [limit["f_p"], limit["F_p"]]).all():
                break
            tolerance_class += 1
        rows.append((cumulative, pitch, teeth.eccentricity, tolerance_class))
    ranges, steps, eccentricities, classes = map(list, zip(*rows, strict=True))
    return labelled_dataset(
        {
            "cumulative": ("gear", ranges, "m", "range of the index deviations, to compare with F_p"),
            "pitch": ("gear", steps, "m", "largest step from tooth to tooth, to compare with f_p"),
            "eccentricity": ("gear", eccentricities, "m", "eccentricity, first order of the deviations"),
            "tolerance_class": ("gear", classes, "1", "least class of ISO 1328-1 that holds; 12: none"),
        },
        {"gear": (list(GEARS), "1", "gear")},
    )


def rpm_and_period(findings: TeethFindings) -> str:
    """Speed and period of the motion, in words."""
    pair = findings.pair
    turns = " and ".join(
        f"{findings.period / getattr(pair, gear).teeth:g} turns of the {gear}" for gear in GEARS
    )
    rpm = to_stated(pair.operating.pinion_speed, "rpm")
    return f"{rpm:.5g} rpm, computed over {turns} ({findings.period} mesh cycles)"
