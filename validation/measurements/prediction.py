"""A prediction as functions of mesh phase, so that it can be read where a record has its samples.

Sources: docs/theory/equations.md, "Periodic motion and the brake torque".
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from lumped import Geometry, steady_state
from lumped.arguments import whole_number
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray
from validation.measurements.record import PAIR_LABELS, QUANTITIES

_SAMPLES = 1024  # per mesh cycle


@dataclass(frozen=True, eq=False)
class Prediction:
    """Periodic motion of a gear pair, read by mesh cycles u since pair A was at point A.

    Attributes
    ----------
    pair : the gear pair at the record's operating point
    cycle : one mesh cycle of results, ``lumped.steady_state``
    recurrence : mesh cycles after which the same labelled pair is in contact again
    """

    pair: GearPair
    cycle: xr.Dataset
    recurrence: int

    @property
    def geometry(self) -> Geometry:
        """Of the pair."""
        return self.pair.geometry

    def age(self, cycles: ArrayLike, label: str) -> FloatArray:
        """Mesh cycles since the labelled pair was last at A; in contact while below the contact ratio."""
        u = np.asarray(cycles, dtype=float) - PAIR_LABELS.index(label)
        return np.asarray(np.mod(u, self.recurrence), dtype=np.float64)

    def contact(self, cycles: ArrayLike, label: str) -> BoolArray:
        """Whether the labelled pair is in contact."""
        return np.asarray(self.age(cycles, label) < self.geometry.contact_ratio, dtype=np.bool_)

    def position(self, cycles: ArrayLike, label: str) -> FloatArray:
        """Position xi of the labelled pair, also beyond D [m]."""
        g = self.geometry
        return np.asarray(g.L_XA + self.age(cycles, label) * g.base_pitch, dtype=np.float64)

    def value(self, quantity: str, cycles: ArrayLike, label: str | None = None) -> FloatArray:
        """A predicted quantity [SI] at mesh cycles u; of one labelled pair where it has pairs."""
        places, values = self._curves[quantity]
        if label is None:
            u = np.mod(np.asarray(cycles, dtype=float), 1.0)
            return np.asarray(np.interp(u, places, values, period=1.0), dtype=np.float64)
        age = self.age(cycles, label)
        inside = age < self.geometry.contact_ratio
        return np.asarray(np.where(inside, np.interp(age, places, values), 0.0), dtype=np.float64)

    @cached_property
    def _curves(self) -> dict[str, tuple[FloatArray, FloatArray]]:
        """Quantity -> mesh cycles and values: over one cycle, or of one tooth pair from A to D.

        Whole cycles after A a tooth pair is that many slots ahead. Past the last sample before D its value
        holds.
        """
        grid = self.cycle["time"].to_numpy() / self.geometry.mesh_period
        slots = np.arange(self.geometry.pairs)
        life = (slots[:, None] + grid).ravel()
        inside = life < self.geometry.contact_ratio
        found = {}
        for name, (_, paired) in QUANTITIES.items():
            values = self.cycle[name].to_numpy()
            found[name] = (life[inside], values[slots[::-1]].ravel()[inside]) if paired else (grid, values)
        return found


def predict(pair: AnyPair, *, recurrence: int | None = None) -> Prediction:
    """Predict the periodic motion of a pair; between samples it is interpolated linearly.

    Parameters
    ----------
    pair : a validated gear pair, at the operating point of the record: ``Measurement.at``
    recurrence : see ``Prediction``; default the pinion's number of teeth
    """
    pair = load_gear_pair(pair)
    again = pair.pinion.teeth
    if recurrence is not None:  # no fewer than the pairs in contact at once
        advice = "Count the mesh cycles until the same labelled pair is in contact again."
        again = whole_number("recurrence", recurrence, pair.geometry.pairs, 1_000_000, advice)
    return Prediction(pair, steady_state(pair, samples_per_cycle=_SAMPLES), again)
