"""Other readings of the curves of another model: signs, units, channels, filters, times.

A reading changes the complex orders of the channels, or which quantity a channel holds. It costs no motion.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from lumped.errors import NumericalError
from lumped.model.periodic_system import LTVSystem, supports_of
from lumped.schema.pair import GearPair
from lumped.typing import ComplexArray, FloatArray
from validation.check.curve_orders import ChannelOrders, orders_of_channel, without_ramp
from validation.check.curves import Channel, Curves
from validation.check.problem import Problem
from validation.check.quantities import PAIR_LABELS, PLACES
from validation.signals.complex_orders import ComplexOrders

#: Channel -> factor, delay or quantity, as sorted pairs, so that a reading can be a key.
ByChannel = tuple[tuple[str, float], ...]
#: Which pair has the first place.
Places = Literal["", "newest pair first", "leading pair first"]
#: Factors of the sections of a Butterworth filter of fourth order.
_FOURTH_ORDER = (2.0 * math.cos(math.pi / 8.0), 2.0 * math.sin(math.pi / 8.0))


@dataclass(frozen=True)
class Reading:
    """How the curves are read. The defaults read them as they are.

    Attributes
    ----------
    factors : channel -> factor that its values have too much
    quantities : channel -> quantity that it holds in place of its own
    places : which place of the mesh the first channel of tooth pairs shows; empty: channels follow a pair
    delays : channel -> delay against the other channels [mesh cycles]
    reversed : whether the time runs backwards
    offsets : channels with another zero, whose means are not compared
    time_constant : of a low-pass filter of first order of all channels, 1 over the mesh order of its cutoff
    both_ways : of a low-pass filter of second order that runs forward and backward, 1 over the mesh order of
        its cutoff
    second_order : of a low-pass filter of second order of all channels, 1 over the mesh order of its cutoff
    fourth_order : the same, of fourth order
    filters : channel -> the same, of a filter of second order of this channel alone
    first_filters : channel -> the same, of first order
    high_pass : mesh order of the cutoff of a high-pass filter of first order of all channels
    window : of a moving average of all channels [mesh cycles]
    most_orders : largest mesh order that the curves have; 0: all of them
    turned_forces : angle [rad] by which the axes of the bearing forces are turned from the line of action
    turned_axes : angle [rad] by which the axes of all displacements and bearing forces are turned from it
    free_shift : whether the phase that the user states is ignored
    decaying : whether free vibrations that decay are taken out of the curves
    refined : whether the curves with half the step are taken
    rounded : whether our samples are rounded in the steps of theirs
    """

    factors: ByChannel = ()
    quantities: tuple[tuple[str, str], ...] = ()
    places: Places = ""
    delays: ByChannel = ()
    reversed: bool = False
    offsets: tuple[str, ...] = ()
    time_constant: float = 0.0
    both_ways: float = 0.0
    second_order: float = 0.0
    fourth_order: float = 0.0
    filters: ByChannel = ()
    first_filters: ByChannel = ()
    high_pass: float = 0.0
    window: float = 0.0
    most_orders: int = 0
    turned_forces: float = 0.0
    turned_axes: float = 0.0
    free_shift: bool = False
    decaying: bool = False
    refined: bool = False
    rounded: bool = False

    def with_factors(self, factors: Mapping[str, float]) -> Reading:
        """Return the reading with further factors, by channel."""
        before = dict(self.factors)
        product = before | {name: before.get(name, 1.0) * factor for name, factor in factors.items()}
        return replace(self, factors=tuple(sorted(product.items())))

    def with_offsets(self, channels: Iterable[str]) -> Reading:
        """Return the reading with further channels that have another zero."""
        return replace(self, offsets=tuple(sorted({*self.offsets, *channels})))

    def with_quantities(self, quantities: Mapping[str, str]) -> Reading:
        """Return the reading with other quantities, by channel."""
        return replace(self, quantities=tuple(sorted((dict(self.quantities) | dict(quantities)).items())))

    def with_delay(self, channels: Iterable[str], delay: float) -> Reading:
        """Return the reading with the delay of channels."""
        delays = dict(self.delays) | dict.fromkeys(channels, delay)
        return replace(self, delays=tuple(sorted(delays.items())))

    def with_filter(self, channels: Iterable[str], time_constant: float, *, second: bool = True) -> Reading:
        """Return the reading with a low-pass filter of channels alone, of second or of first order."""
        field = "filters" if second else "first_filters"
        filters = dict(getattr(self, field)) | dict.fromkeys(channels, time_constant)
        changed: dict[str, Any] = {field: tuple(sorted(filters.items()))}
        return replace(self, **changed)


def quantities_by_place(problem: Problem, reading: Reading) -> dict[str, str]:
    """Return the quantity of each channel of a tooth pair that shows a place of the mesh.

    Our motion has the pair ahead first. The first label, A, is the first place of the other model.
    """
    if not reading.places:
        return {}
    rows = int(problem.motion.motion["normal_load"].shape[0])
    result = {}
    for channel in problem.curves.channels:
        if channel.tooth_pair is None:
            continue
        place = PAIR_LABELS.index(channel.tooth_pair)
        row = place if reading.places == "leading pair first" else rows - 1 - place
        result[channel.name] = f"{channel.quantity} in place {row % PLACES}"
    return result


def steps_of(problem: Problem, reading: Reading) -> dict[str, float]:
    """Return the steps in which a reading rounds our samples, by channel, in the units of the reading."""
    if not reading.rounded:
        return {}
    factors = dict(reading.factors)
    return {name: step / abs(factors.get(name, 1.0)) for name, step in problem.steps.items()}


#: The curves as they are.
AS_THEY_ARE = Reading()


def read(problem: Problem, reading: Reading) -> tuple[ChannelOrders, ...]:
    """Return the channels of a problem by their orders, in a reading."""
    factors = dict(reading.factors)
    quantities = quantities_by_place(problem, reading) | dict(reading.quantities)
    delays = dict(reading.delays)
    filters, first_filters = dict(reading.filters), dict(reading.first_filters)
    result = []
    for one in _in_our_axes(_channels(problem, reading), reading):
        channel = one.channel
        orders = _scaled(one.orders, 1.0 / factors.get(channel.name, 1.0))
        if channel.name in delays:
            orders = _times(orders, np.exp(2j * np.pi * orders.orders * delays[channel.name]))
        if reading.reversed:
            orders = replace(orders, values=orders.values.conj())
        channel = replace(channel, quantity=quantities.get(channel.name, channel.quantity))
        offset = channel.name in reading.offsets
        own = filters.get(channel.name, 0.0), first_filters.get(channel.name, 0.0)
        gains = _gains(reading, orders.orders, *own)
        result.append(ChannelOrders(channel, orders, gains=gains, offset=offset))
    return tuple(result)


def _gains(reading: Reading, orders: FloatArray, own: float, own_first: float) -> ComplexArray | None:
    """Gains of the filters of a reading, and of a channel of its own, at mesh orders; None: no filter.

    A low-pass filter of first order has 1/(1 + i m tau), a moving average over w cycles sin(pi m w)/(pi m w),
    a Butterworth filter of second order 1/(1 + i sqrt(2) m tau - (m tau)^2), of fourth order the product of
    two such with 2 cos(pi/8) and 2 sin(pi/8) for sqrt(2), both ways 1/(1 + (m tau)^4), a high-pass filter
    i m/(i m + c).
    """
    second = (max(reading.second_order, 0.0), max(own, 0.0))
    fourth = max(reading.fourth_order, 0.0)
    filters = (reading.time_constant, reading.window, reading.both_ways, reading.high_pass, *second, fourth)
    if max(*filters, own_first) <= 0.0 and reading.most_orders == 0:
        return None
    gains = np.sinc(orders * reading.window) / (1.0 + 1j * orders * reading.time_constant)
    gains = gains / (1.0 + 1j * orders * max(own_first, 0.0))
    gains = gains / (1.0 + (orders * reading.both_ways) ** 4)
    for constant in second:
        gains = gains / (1.0 + 1j * math.sqrt(2.0) * orders * constant - (orders * constant) ** 2)
    for damping in _FOURTH_ORDER:
        gains = gains / (1.0 + 1j * damping * orders * fourth - (orders * fourth) ** 2)
    gains = gains * 1j * orders / (1j * orders + max(reading.high_pass, 0.0))
    if reading.most_orders:
        gains = np.where(orders <= reading.most_orders + 1e-9, gains, 0.0)
    return gains.conj() if reading.reversed else gains


def turning_channels(channels: Iterable[Channel], *, forces_only: bool) -> tuple[tuple[str, str], ...]:
    """Return the names of channels along and across the line of action, of the same kind and gear."""
    names = {channel.quantity: channel.name for channel in channels if channel.tooth_pair is None}
    return tuple(
        (names[quantity], names[other])
        for quantity in names
        if (other := quantity.replace("x_", "y_")) != quantity and other in names
        if quantity.startswith("bearing_force_") or not forces_only
    )


def _in_our_axes(channels: tuple[ChannelOrders, ...], reading: Reading) -> tuple[ChannelOrders, ...]:
    """Channels along and across the line of action, of channels in axes that are turned from it.

    x' = x cos(a) - y sin(a) and y' = x sin(a) + y cos(a) are solved for x and y.
    """
    by_name = {one.channel.name: one for one in channels}
    for angle, forces_only in ((reading.turned_axes, False), (reading.turned_forces, True)):
        if angle == 0.0:
            continue
        cosine, sine = math.cos(angle), math.sin(angle)
        for along, across in turning_channels((one.channel for one in channels), forces_only=forces_only):
            x, y = by_name[along].orders, by_name[across].orders
            by_name[along] = by_name[along]._replace(orders=_sum(x, cosine, y, sine))
            by_name[across] = by_name[across]._replace(orders=_sum(y, cosine, x, -sine))
    return tuple(by_name.values())


def _sum(one: ComplexOrders, factor: float, other: ComplexOrders, other_factor: float) -> ComplexOrders:
    """Orders of a sum of two signals with factors."""
    return replace(
        one,
        values=factor * one.values + other_factor * other.values,
        mean=factor * one.mean + other_factor * other.mean,
        covariance=factor**2 * one.covariance + other_factor**2 * other.covariance,
    )


def _channels(problem: Problem, reading: Reading) -> tuple[ChannelOrders, ...]:
    """The channels of the settled samples, of refined curves, or without free vibrations."""
    if reading.refined and problem.refined is not None:
        finer = Problem(problem.pair, problem.refined, problem.motion, problem.frequency, problem.given_shift)
        return finer.theirs
    if reading.decaying:
        return without_free_vibrations(problem)
    return problem.theirs


def without_free_vibrations(problem: Problem) -> tuple[ChannelOrders, ...]:
    """Return the channels without the free vibrations of the pair, which decay.

    A least-squares fit has the orders and, for each mode of the mean system, a decaying cosine and sine.
    """
    used = np.ones(problem.cycles.size, dtype=bool)
    waves = _free_vibrations(problem.pair, problem.cycles)
    result = []
    for one in problem.theirs:
        if one.channel.tooth_pair is not None:
            result.append(one)
            continue
        values = one.channel.values[used]
        if one.channel.kind.is_rotation:
            values = without_ramp(problem.cycles, values)
        angle = 2.0 * np.pi * np.multiply.outer(problem.cycles, one.orders.orders)
        steady = np.hstack([np.ones((values.size, 1)), np.cos(angle), -np.sin(angle)])
        fit = np.linalg.lstsq(np.hstack([steady, waves]), values, rcond=1e-10)[0]
        settled = replace(one.channel, values=values - waves @ fit[steady.shape[1] :])
        orders = orders_of_channel(settled, problem.cycles, one.orders.orders, problem.motion, 0.0)
        result.append(ChannelOrders(settled, orders))
    return tuple(result)


def _free_vibrations(pair: GearPair, cycles: FloatArray) -> FloatArray:
    """Decaying cosines and sines (k, 2 modes) of the mean system over the mesh cycles of the samples."""
    system = LTVSystem.of(pair.healthy, "elastic", supports=supports_of(pair, None))
    times = (np.arange(64) + 0.5) / 64 * system.period
    mean = system.matrices(times).mean(axis=0)
    rates = np.asarray(np.linalg.eigvals(mean) * system.period, dtype=np.complex128)
    rates = rates[(rates.imag > 0.0) & (rates.real < 0.0)]
    if not rates.size:
        raise NumericalError("The pair has no free vibration that decays.")
    waves = np.exp(np.multiply.outer(cycles - cycles[0], rates))
    return np.asarray(np.hstack([waves.real, waves.imag]), dtype=np.float64)


def _scaled(orders: ComplexOrders, factor: float) -> ComplexOrders:
    """Orders times a real factor, with the mean."""
    if factor == 1.0:
        return orders
    return replace(
        orders,
        values=orders.values * factor,
        mean=orders.mean * factor,
        covariance=orders.covariance * factor**2,
    )


def _times(orders: ComplexOrders, factors: NDArray[np.complexfloating[Any, Any]]) -> ComplexOrders:
    """Orders times complex factors. The mean and the covariance stay."""
    return replace(orders, values=orders.values * factors)


#: Families of one unit: a program writes all its lengths in millimetres, or all its forces in kilonewtons.
_BY_UNIT = {"m": "all lengths", "N": "all forces"}


def families(channels: tuple[Channel, ...]) -> dict[str, tuple[str, ...]]:
    """Return groups of at least two channels that share a convention: words -> names of the channels."""
    members: dict[str, list[str]] = {}
    for channel in channels:
        for words in _families_of(channel):
            members.setdefault(words, []).append(channel.name)
    groups = {words: tuple(names) for words, names in members.items() if len(names) > 1}
    unique: dict[tuple[str, ...], str] = {}
    for words, names in groups.items():
        unique.setdefault(names, words)
    return {words: names for names, words in unique.items()}


def _families_of(channel: Channel) -> list[str]:
    """Words for the groups to which a channel belongs."""
    name = channel.quantity
    stem = name.removesuffix("_ddot").removesuffix("_dot")
    words = ["all channels"]
    if name.startswith("bearing_force"):
        words.append("all bearing forces")
    elif stem.startswith("theta"):
        words.append("all rotations")
    elif stem[:2] in ("x_", "y_"):
        words.append("all displacements of the gears")
    elif channel.kind.unit == "N":
        words.append("all tooth forces")
    if name.endswith("_ddot"):
        words.append("all accelerations")
    elif name.endswith("_dot"):
        words.append("all rates")
    if stem[:2] in ("x_", "y_") or name.startswith("bearing_force"):
        line = "along" if "x_" in name else "across"
        words.append(f"everything {line} the line of action")
    if stem.startswith("y_") or name.startswith(("bearing_force_y", "friction")):
        words.append("everything across the line of action, with friction")
    if stem.endswith("_p") and not name.startswith("mesh"):
        words.append("everything of the pinion")
    if stem.endswith("_g") and not name.startswith("mesh"):
        words.append("everything of the gear")
    if channel.kind.unit in _BY_UNIT:  # last: where all forces are bearing forces, these are named
        words.append(_BY_UNIT[channel.kind.unit])
    return words


def refined_curves_fit(curves: Curves, refined: Curves) -> bool:
    """Return whether refined curves have the channels of the curves."""
    return [channel.name for channel in curves.channels] == [channel.name for channel in refined.channels]
