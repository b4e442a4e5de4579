"""A periodic motion of ours, read as the quantities of another model: values by mesh cycles, complex orders.

A motion is a dataset of ``lumped.steady_state`` or ``multibody.steady_state`` at equal steps over its period,
which is one mesh cycle or several. Mesh cycles count from the moment at which tooth pair A is at point A.

Sources: docs/theory/equations.md, "Frame", for the mesh phase.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from lumped.errors import refuse
from lumped.model.results import PlainMotion, plain
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, IntArray
from validation.check.quantities import (
    DISPLACEMENTS_TOO_MUCH,
    MISTAKEN,
    PAIR_LABELS,
    QUANTITIES,
    Quantity,
    quantity_of,
)
from validation.signals.complex_orders import ComplexOrders, orders_of_period

#: Samples by which a path of contact must end elsewhere to be another one.
_OTHER_END = 2.0


class _Life(NamedTuple):
    """A quantity of a tooth pair over the mesh cycles ``age`` since the pair was at A."""

    age: FloatArray
    values: FloatArray


@dataclass(frozen=True, eq=False)
class MotionCurves:
    """A periodic motion of a gear pair, by mesh cycles.

    Attributes
    ----------
    pair : the gear pair
    plain : the motion as arrays at equal steps over ``mesh_cycles``
    mesh_cycles : mesh cycles in the period of the motion
    recurrence : mesh cycles after which the same labelled tooth pair is in contact again
    """

    pair: GearPair
    plain: PlainMotion
    mesh_cycles: int
    recurrence: int
    _samples: dict[str, FloatArray] = field(default_factory=dict, init=False, repr=False)
    _orders: dict[tuple[str, int], ComplexOrders] = field(default_factory=dict, init=False, repr=False)

    @classmethod
    def of(cls, pair: GearPair, motion: xr.Dataset, mesh_cycles: int, recurrence: int) -> MotionCurves:
        """Return the curves of a dataset at equal steps over ``mesh_cycles``."""
        return cls(pair, plain(motion), mesh_cycles, recurrence)

    @property
    def motion(self) -> xr.Dataset:
        """The motion as a dataset, which takes longer than its arrays."""
        return self.plain.dataset

    def has(self, quantity: str) -> bool:
        """Return whether the motion contains a quantity."""
        return quantity_of(quantity).variable in self.plain.values

    def samples(self, quantity: str) -> FloatArray:
        """Return a quantity at the times of the motion, (n,), or (pair, n) for a quantity of tooth pairs."""
        if quantity not in self._samples:
            self._samples[quantity] = self._computed(quantity)
        return self._samples[quantity]

    def _computed(self, quantity: str) -> FloatArray:
        """A quantity at the times of the motion."""
        kind = quantity_of(quantity)
        if not self.has(quantity):
            allowed = ", ".join(name for name in QUANTITIES if self.has(name))
            raise refuse("channel", quantity, allowed, "Leave the channel out.")
        values = np.asarray(self.plain.values[kind.variable], dtype=np.float64)
        if kind.summed:
            values = values.sum(axis=0)
        if kind.derivative:
            values = self._derivative(values, kind.derivative)
        if quantity.startswith("mesh_torque"):
            values = self._mesh_torque(kind, values)
        if quantity in MISTAKEN:
            values = self._mistaken(quantity, values)
        if quantity.startswith("|"):
            values = np.abs(values)
        if quantity in DISPLACEMENTS_TOO_MUCH:
            share = DISPLACEMENTS_TOO_MUCH[quantity]
            values = values + share.pinion * self.plain.values["x_p"]
            values = values + share.gear * self.plain.values["x_g"]
        return values

    def _mistaken(self, quantity: str, values: FloatArray) -> FloatArray:
        """What a quantity is mistaken for, of the samples of its variable."""
        g = self.pair.geometry
        if quantity == "dte less the static one":  # prescribed contact of perfect teeth: F/K
            force = self.pair.operating.pinion_torque / g.base_radius_pinion
            return np.asarray(self.plain.values["dte"] - force / values)
        if quantity == "mesh force of the springs":
            return np.asarray(self.plain.values["dte"] * values)
        if quantity == "dte on the pitch circles":
            displaced = self.plain.values["x_p"] - self.plain.values["x_g"]
            return np.asarray((values - displaced) / np.cos(g.operating_pressure_angle) + displaced)
        if quantity.startswith("resultant"):
            across = self.plain.values[f"bearing_force_y_{quantity[-1]}"]
            return np.asarray(np.hypot(values, across))
        if quantity == "friction without signs":
            return np.asarray(np.abs(values).sum(axis=0))
        if " in place " in quantity:
            place = int(quantity[-1])
            return np.asarray(values[place] if place < len(values) else np.zeros(values.shape[1]))
        if quantity in ("whole load of the mesh", "share of the static load", "load times its share"):
            return self._by_share(quantity, values)
        if quantity == "equal share of the load":
            touches = self.plain.values["contact"] > 0
            return np.asarray(touches * values.sum(axis=0) / np.maximum(touches.sum(axis=0), 1))
        return values

    def _by_share(self, quantity: str, loads: FloatArray) -> FloatArray:
        """What the load of a tooth pair is mistaken for, by its share of the mesh force (pairs, n) [N]."""
        touches = self.plain.values["contact"] > 0
        total = loads.sum(axis=0)
        if quantity == "whole load of the mesh":
            return np.asarray(touches * total)
        share = touches * loads / np.where(total == 0.0, 1.0, total)
        static = self.pair.operating.pinion_torque / self.pair.geometry.base_radius_pinion
        return np.asarray(share * (static if quantity == "share of the static load" else loads))

    def thinned(self, samples: int) -> MotionCurves:
        """Return the motion with so many samples in a mesh cycle, where it has a multiple of them."""
        step, rest = divmod(self.plain.time.size, samples * self.mesh_cycles)
        if step < 2 or rest:
            return self
        every = slice(None, None, step)
        values = {name: array[..., every] for name, array in self.plain.values.items()}
        thin = replace(
            self.plain,
            time=self.plain.time[every],
            values=values,
            make_dataset=lambda: self.motion.isel(time=every),
        )
        return MotionCurves(self.pair, thin, self.mesh_cycles, self.recurrence)

    def mean_cycle(self) -> MotionCurves:
        """Return the motion averaged over the mesh cycles of its period."""
        if self.mesh_cycles == 1:  # a copy of every variable would take longer than the motion
            return self
        size = self.plain.time.size // self.mesh_cycles
        first = self.motion.isel(time=slice(0, size))
        for name, variable in self.motion.data_vars.items():
            if "time" in variable.dims and name != "position":
                values = variable.to_numpy()[..., : self.mesh_cycles * size]
                by_cycle = values.reshape(*values.shape[:-1], self.mesh_cycles, size)
                first[name] = first[name].copy(data=by_cycle.mean(axis=-2))
        return MotionCurves.of(self.pair, first, 1, self.recurrence)

    def age(self, cycles: ArrayLike, label: str) -> FloatArray:
        """Return the mesh cycles since the labelled pair was last at A; negative before A.

        With loaded contact pairs touch before A.
        """
        since = np.mod(np.asarray(cycles, dtype=float) - PAIR_LABELS.index(label), self.recurrence)
        before_contact = self.recurrence + self.life[0]
        return np.asarray(np.where(since >= before_contact, since - self.recurrence, since), dtype=np.float64)

    @cached_property
    def ahead(self) -> IntArray:
        """Whole base pitches from the pair at A at the start to each tooth pair of the motion.

        With loaded contact pairs touch before A and behind D, so the last number is negative.
        """
        g = self.pair.geometry
        place = self.plain.values["position"][:, 0] - g.L_XA
        return np.asarray(np.round(place / g.base_pitch), dtype=np.int64)

    @property
    def life(self) -> tuple[float, float]:
        """First and last mesh cycle since A at which a tooth pair can carry load.

        With loaded contact the life is longer than the path from A to D, and an altered path has other ends.
        """
        return self._life_of_pair

    @cached_property
    def _life_of_pair(self) -> tuple[float, float]:
        if self.pair.mesh.contact == "loaded":
            return float(self.ahead.min()), float(self.ahead.max()) + 1.0
        g = self.pair.geometry
        touches = self.plain.values["contact"] > 0
        if not touches.any():
            return 0.0, g.contact_ratio
        step = self.mesh_cycles / self.plain.time.size
        cycles = (self.plain.values["position"][touches] - g.L_XA) / g.base_pitch
        first, last = float(cycles.min()), float(cycles.max()) + step
        first = first if abs(first) > _OTHER_END * step else 0.0
        return first, last if abs(last - g.contact_ratio) > _OTHER_END * step else g.contact_ratio

    def at(self, quantity: str, cycles: ArrayLike, label: str | None = None) -> FloatArray:
        """Return a quantity [SI] at mesh cycles; ``label``: tooth pair of a quantity of tooth pairs.

        Between samples the value is interpolated linearly.
        """
        if label is None or " in place " in quantity:
            values = self.samples(quantity)
            grid = np.arange(values.size) * (self.mesh_cycles / values.size)
            within = np.mod(np.asarray(cycles, dtype=float), self.mesh_cycles)
            return np.asarray(np.interp(within, grid, values, period=self.mesh_cycles), dtype=np.float64)
        age = self.age(cycles, label)
        first, last = self.life
        life = self._life(quantity)
        inside = (age >= first) & (age < last)
        return np.asarray(np.where(inside, np.interp(age, life.age, life.values), 0.0), dtype=np.float64)

    def orders(self, quantity: str, mesh_orders: int) -> ComplexOrders:
        """Return the complex orders of a quantity of the whole mesh, up to a mesh order."""
        key = quantity, mesh_orders
        if key not in self._orders:
            self._orders[key] = orders_of_period(self.samples(quantity), mesh_orders, self.mesh_cycles)
        return self._orders[key]

    def _life(self, quantity: str) -> _Life:
        """Quantity of a tooth pair over its life. A tooth pair n pitches ahead is n mesh cycles after A."""
        values = self.samples(quantity)
        grid = np.arange(values.shape[1]) / values.shape[1]
        by_age = np.argsort(self.ahead)
        age = (self.ahead[by_age][:, None] + grid).ravel()
        first, last = self.life
        inside = (age >= first) & (age < last)
        return _Life(age[inside], values[by_age].ravel()[inside])

    def _derivative(self, values: FloatArray, times: int) -> FloatArray:
        """Derivative in time of periodic samples (..., n), by their Fourier series."""
        duration = self.mesh_cycles * self.pair.geometry.mesh_period
        rates = 2j * np.pi * np.fft.rfftfreq(values.shape[-1], duration / values.shape[-1])
        return np.asarray(np.fft.irfft(np.fft.rfft(values) * rates**times, values.shape[-1]))

    def _mesh_torque(self, kind: Quantity, acceleration: FloatArray) -> FloatArray:
        """Torque of the mesh against a gear, T - J theta'', positive in mean. On springs only.

        The torque on the pinion is the constant drive torque less J theta''; on the gear the mesh drives: the
        torque is J theta'' plus the brake torque, with the sign of the gear's nominal rotation.
        """
        if self.pair.shafts is not None:
            allowed = "any other quantity for a pair on shafts"
            raise refuse("channel", kind.name, allowed, "Leave the channel out; give mesh_force.")
        bodies = bodies_of(self.pair)
        if kind.name.endswith("_p"):
            return float(self.plain.attributes["pinion_torque"]) - bodies.inertia_pinion * acceleration
        return float(self.plain.attributes["brake_torque"]) + bodies.inertia_gear * acceleration
