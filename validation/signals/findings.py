"""What teeth that differ do to a pair, beside its twin with like teeth: one dataset for report and command.

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

#: White noise of a sensor in a time-synchronous average, over the root mean square of the healthy twin's.
NOISE = 0.01
#: Share of the mesh harmonic's amplitude from which a sideband counts as audible or measurable.
_SEEN = 0.01
GEARS: tuple[Gear, Gear] = ("pinion", "gear")


class TeethFindings:
    """Motion of a pair whose teeth differ, and of its twin with like teeth; refused where teeth are alike.

    ``supports``: of both, by default the shafts of a pair that has them; ``motion``: that of the pair, if it
    is known.
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
    def static_force(self) -> float:
        """Mean mesh force [N]."""
        return self.pair.operating.pinion_torque / self.pair.geometry.base_radius_pinion

    @staticmethod
    def load(result: xr.Dataset) -> float:
        """Largest load of one tooth pair [N]."""
        return float(result["normal_load"].max())

    @cached_property
    def contact_lost(self) -> tuple[tuple[int, int], ...]:
        """Teeth (pinion, gear) at which the total mesh force is zero; empty where contact is kept."""
        total = self.motion["normal_load"].sum("pair").to_numpy()
        at = np.flatnonzero(total <= 0.0)
        teeth = (self.motion[f"{gear}_tooth"].isel(pair=0).to_numpy()[at] for gear in GEARS)
        return tuple(sorted({(int(p), int(g)) for p, g in zip(*teeth, strict=True)}))

    @cached_property
    def largest_loads(self) -> FloatArray:
        """(z1, z2) largest load of each meeting pair [N]; NaN for teeth that never meet."""
        found = np.full((self.pair.pinion.teeth, self.pair.gear.teeth), np.nan)
        teeth = (self.motion[f"{gear}_tooth"].to_numpy().ravel() - 1 for gear in GEARS)
        np.fmax.at(found, tuple(teeth), self.motion["normal_load"].to_numpy().ravel())
        return np.where(found > 0.0, found, np.nan)

    @cached_property
    def rates(self) -> tuple[float, float]:
        """Growth of a perturbation in one mesh cycle, |multiplier|^(1/cycles), of the pair and its twin."""
        found = floquet.revolution_multipliers(self.pair, supports=self.supports)
        return found.rate, found.healthy_rate

    def spectrum(self, gear: Gear, variable: str = "dte") -> xr.Dataset:
        """Amplitudes over the orders of a shaft, of the pair and of its twin."""
        found = order_spectrum(self.motion, gear, variable=variable)
        twin = order_spectrum(self.twin, gear, variable=variable)
        healthy = np.zeros(found.sizes["order"])
        healthy[:: self.period] = twin["amplitude"].to_numpy()[: healthy[:: self.period].size]
        words = "amplitude of the twin with like teeth"
        attributes = {"units": found["amplitude"].attrs["units"], "long_name": words}
        return found.assign(healthy=("order", healthy, attributes))

    def indicators(self, gear: Gear) -> xr.Dataset:
        """Condition indicators of the pinion's acceleration, with the noise of ``NOISE``."""
        quiet = indicators(self.motion, gear)["value"]
        floor = NOISE * float(quiet.sel(indicator="RMS", record="healthy twin"))
        return indicators(self.motion, gear, noise_floor=floor)

    @cached_property
    def sentence(self) -> str:
        """What a listener or a sensor finds."""
        parts = []
        for gear in GEARS:
            if not self._turns(gear):
                continue
            z = {"pinion": self.pair.pinion.teeth, "gear": self.pair.gear.teeth}[gear]
            ratio = sidebands(self.motion, gear)["ratio"].sel(mesh_order=1)
            ratio = ratio.where(ratio["sideband"] != 0, 0.0)
            at = int(ratio["sideband"][int(np.argmax(ratio.to_numpy()))])
            share = float(ratio.max())
            hertz = self.pair.geometry.mesh_frequency / z
            size = f"{100 * share:.2g} % of it at order {z + at}" if share >= _SEEN else "below 1 % of it"
            rms = self.indicators(gear)["value"].sel(indicator="RMS_residual")
            times = float(rms.sel(record="pair") / rms.sel(record="healthy twin"))
            parts.append(
                f"the mesh tone has sidebands every {hertz:.3g} Hz, once a turn of the {gear}, {size}, "
                f"and an accelerometer shows {times:.2g} times the residual signal of like teeth"
            )
        lost = self.contact_lost
        where = f"; contact is lost at {len(lost)} meeting teeth" if lost else "; contact is kept"
        text = f"{'; '.join(parts) or 'only the torque differs'}{where}."
        return text[0].upper() + text[1:]

    def _turns(self, gear: Gear) -> bool:
        return bool(getattr(self.pair, gear).has_own_teeth)


def deviations_table(pair: GearPair) -> xr.Dataset:
    """Index deviations of both gears beside the tolerances of ISO 1328-1:2013.

    Returns
    -------
    xarray.Dataset over ``gear``: ``cumulative`` and ``pitch``, their range and largest step [m];
    ``eccentricity`` [m]; ``tolerance_class``, the least class whose F_p and f_p hold, 12 for none
    """
    rows = []
    for teeth in tooth_errors(pair):
        cumulative = float(np.ptp(teeth.index))
        pitch = float(np.abs(np.diff(teeth.index, prepend=teeth.index[-1])).max())
        # A drawn gear meets one of its tolerances to rounding.
        size = (1.0 - 1e-9) * np.array([pitch, cumulative])
        held = 1
        while held < 12:
            limit = flank_tolerances(teeth.index.size, pair.basic_rack.module, held)
            if (size <= [limit["f_p"], limit["F_p"]]).all():
                break
            held += 1
        rows.append((cumulative, pitch, teeth.eccentricity, held))
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


def rpm_and_period(found: TeethFindings) -> str:
    """Speed and period of the motion, in words."""
    pair = found.pair
    turns = " and ".join(
        f"{found.period / getattr(pair, gear).teeth:g} turns of the {gear}" for gear in GEARS
    )
    rpm = to_stated(pair.operating.pinion_speed, "rpm")
    return f"{rpm:.5g} rpm the motion repeats after {found.period} mesh cycles, {turns}"
