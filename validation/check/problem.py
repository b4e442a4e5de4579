"""Curves of another model, prepared for the comparison with motions of ours."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np

from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray
from validation.check.curve_orders import (
    ChannelOrders,
    coarse_shift,
    compared_orders,
    noise_in_orders,
    orders_of_channel,
    shows_contact,
)
from validation.check.curves import Channel, Curves
from validation.check.digits import coarse_step
from validation.check.mesh_frequency import Frequency, mesh_frequency, nominal_cycles
from validation.check.misfit import Misfit, misfit_of
from validation.check.motion_curves import MotionCurves
from validation.check.settled import Settled, settled
from validation.signals.complex_orders import ComplexOrders, complex_orders

#: Noise below this share of the motion needs no second estimate.
_FREE_OF_NOISE = 2e-3
#: Samples in a mesh cycle from which on high orders do not pass for low ones.
_COARSE = 400.0


@dataclass(frozen=True, eq=False)
class Problem:
    """The curves of another model of a pair, and our motion of that pair.

    Attributes
    ----------
    pair : the gear pair, at the speed and torque of the curves
    curves : the curves
    motion : our motion of the pair
    frequency : mesh frequency of the curves over that of the pair, and what mistakes it
    given_shift : mesh cycles from the moment when pair A was at A to the first sample, where the user states
        them; None: the shift is searched
    refined : curves of the same model with half the step; None: the model cannot be called so
    """

    pair: GearPair
    curves: Curves
    motion: MotionCurves
    frequency: Frequency
    given_shift: float | None = None
    refined: Curves | None = None

    @classmethod
    def of(
        cls,
        pair: GearPair,
        curves: Curves,
        motion: MotionCurves,
        shift: float | None = None,
        refined: Curves | None = None,
    ) -> Problem:
        """Return the problem of curves and a motion, with the mesh frequency that the curves show."""
        frequency = mesh_frequency(curves, pair, mistakes=curves.role == "model")
        return cls(pair, curves, motion, frequency, shift, refined)

    @cached_property
    def cycles(self) -> FloatArray:
        """(k,) mesh cycles of all samples, from 0 on, at the mesh frequency of the curves."""
        return np.asarray(nominal_cycles(self.curves, self.pair) * self.frequency.factor)

    @cached_property
    def settled(self) -> Settled:
        """How far the curves have settled, and which samples are compared."""
        return settled(self.curves, self.cycles, self.motion.mesh_cycles)

    @property
    def means(self) -> bool:
        """Whether means are compared: sensors have no zero."""
        return self.curves.role == "model"

    @cached_property
    def orders(self) -> FloatArray:
        """(m,) orders at which channels of the whole mesh are compared."""
        return compared_orders(self.pair, self.cycles[self.settled.used], self.motion.mesh_cycles)

    @cached_property
    def coarse_shift(self) -> float | None:
        """Shift to a bin, which channels of tooth pairs need; None: no channel of a tooth pair."""
        if all(channel.tooth_pair is None for channel in self.curves.channels):
            return None
        return coarse_shift(self.curves.channels, self.cycles, self.motion)

    @cached_property
    def theirs(self) -> tuple[ChannelOrders, ...]:
        """The channels by their orders, of the settled samples."""
        return self.orders_of(self.curves.channels)

    @cached_property
    def misfit(self) -> Misfit:
        """Misfit of the curves and our motion of the pair."""
        return self.misfit_with(self.motion)

    def orders_of(self, channels: Iterable[Channel]) -> tuple[ChannelOrders, ...]:
        """Return channels, with samples at the times of the curves, by their orders."""
        shift = self.given_shift if self.given_shift is not None else self.coarse_shift or 0.0
        listed = list(channels)
        shown = [channel for channel in listed if self._shows(channel, shift)]
        result = []
        for channel in shown or listed:
            used = self.used(channel)
            settled_channel = replace(channel, values=channel.values[used])
            orders = orders_of_channel(settled_channel, self.cycles[used], self.orders, self.motion, shift)
            noise = self._noise(settled_channel, self.cycles[used], orders)
            result.append(ChannelOrders(channel, orders, noise))
        return tuple(result)

    def _noise(self, channel: Channel, cycles: FloatArray, orders: ComplexOrders) -> float:
        """Root of the expected square of the noise in all orders of a channel, see ``ChannelOrders``.

        White noise is seen by differences of neighbouring samples, and by the difference of two halves of
        the curves. Only the first takes jumps and high orders in few samples for noise, only the second a
        motion that has not settled: the smaller one is noise. Curves of less than two cycles count as free
        of noise.
        """
        white = noise_in_orders(channel.values, orders.orders.size)
        period = orders.period
        if white < _FREE_OF_NOISE * orders.size:
            return white
        if channel.tooth_pair is not None:
            return white
        step = float(np.median(np.diff(cycles)))
        half = int(np.ptp(cycles) + 1.01 * step) // (2 * period) * period
        if half < 1:
            return 0.0
        ends = (cycles[-1] - half, cycles[-1] - 2 * half)
        fits = []
        for end in ends:
            inside = (cycles > end + 1e-9) & (cycles <= end + half + 1e-9)
            values = channel.values[inside]
            if values.size < 2 * (2 * orders.orders.size + 1):
                return 0.0
            fits.append(complex_orders(cycles[inside], values, orders.orders, period=period))
        of_halves = 0.5 * float(np.linalg.norm(fits[0].values - fits[1].values))
        return min(white, of_halves)

    def used(self, channel: Channel) -> BoolArray:
        """(k,) samples of a channel that are compared.

        All samples of a tooth pair where the settled part is too short to show it from end to end.
        """
        settled_cycles = float(np.ptp(self.cycles[self.settled.used]))
        if channel.tooth_pair is not None and settled_cycles < 2 * self.motion.recurrence + 1:
            return np.ones(self.cycles.size, dtype=bool)
        return self.settled.used

    def _shows(self, channel: Channel, shift: float) -> bool:
        """Whether the compared samples show the tooth pair of a channel from end to end."""
        used = self.used(channel)
        settled_channel = replace(channel, values=channel.values[used])
        return shows_contact(settled_channel, self.cycles[used], self.motion, shift)

    def misfit_with(
        self,
        motion: MotionCurves,
        theirs: tuple[ChannelOrders, ...] | None = None,
        *,
        free_shift: bool = False,
        near_coarse: bool = True,
        steps: Mapping[str, float] = MappingProxyType({}),
    ) -> Misfit:
        """Return the misfit of channels (by default those of the curves) and another motion of ours.

        ``free_shift`` says whether the shift is searched although the user states it, ``near_coarse`` whether
        near the coarse one, which channels of tooth pairs need. ``steps`` are the steps [SI] in which samples
        of channels are rounded, ours as theirs.
        """
        channels_of_theirs = self.theirs if theirs is None else theirs
        # Without a channel that shows a tooth pair from end to end the shift is that of the mesh cycle alone.
        of_pairs = any(one.channel.tooth_pair for one in channels_of_theirs)
        misfit = misfit_of(
            channels_of_theirs,
            motion,
            shift=None if free_shift else self.given_shift,
            near=self.coarse_shift if near_coarse and of_pairs else None,
            means=self.means,
        )
        if not steps and not self._is_coarse:
            return misfit
        return self._sampled_alike(misfit, motion, self._fit, steps)

    @cached_property
    def steps(self) -> Mapping[str, float]:
        """Channel of the whole mesh -> step in which its values are written, where few digits show."""
        steps = {one.name: coarse_step(one.values) for one in self.curves.channels if one.tooth_pair is None}
        return {name: step for name, step in steps.items() if step > 0.0}

    @cached_property
    def _is_coarse(self) -> bool:
        """Whether the curves have so few samples in a mesh cycle that high orders pass for low ones."""
        cycles = self.cycles[self.settled.used]
        return bool(cycles.size < _COARSE * max(float(np.ptp(cycles)), 1e-300))

    @cached_property
    def _fit(self) -> FloatArray:
        """(2m+1, k) matrix from samples to mean, real and imaginary parts of the orders, by least squares."""
        cycles = self.cycles[self.settled.used]
        angle = 2.0 * np.pi * np.multiply.outer(cycles, self.orders)
        waves = np.hstack([np.ones((cycles.size, 1)), np.cos(angle), -np.sin(angle)])
        return np.asarray(np.linalg.pinv(waves))

    def _sampled_alike(
        self, misfit: Misfit, motion: MotionCurves, fit: FloatArray, steps: Mapping[str, float]
    ) -> Misfit:
        """Misfit with our orders fitted to samples at the times of the curves, as theirs are.

        In few samples a mesh cycle high orders pass for low ones, in our samples as in theirs. Rounded ones
        have orders of their steps.
        """
        cycles = self.cycles[self.settled.used] + misfit.shift
        count = self.orders.size
        channels = []
        for row in misfit.channels:
            channel = row.channel.channel
            if channel.tooth_pair is None and row.ours.orders.size == count:
                samples = motion.at(channel.quantity, cycles)
                if step := steps.get(channel.name):
                    samples = step * np.round(samples / step)
                coefficients = fit @ samples
                values = coefficients[1 : count + 1] + 1j * coefficients[count + 1 :]
                ours = replace(row.ours, values=values, mean=float(coefficients[0]))
                row = row._replace(ours=row.channel.recorded(ours))
            channels.append(row)
        return replace(misfit, channels=tuple(channels))
