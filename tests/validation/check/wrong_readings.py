"""Curves that are written wrongly: swapped, turned, filtered by formulas of their own."""

from dataclasses import replace

import numpy as np
import scipy.signal


def changed(curves, names, change):
    """Curves with ``change(values)`` of some channels."""
    channels = (
        replace(one, values=change(one.values)) if one.name in names else one for one in curves.channels
    )
    return replace(curves, channels=tuple(channels))


def swapped(curves, one, other):
    """Curves with two channels in each other's place."""
    values = {channel.name: channel.values for channel in curves.channels}
    values[one], values[other] = values[other], values[one]
    return replace(curves, channels=tuple(replace(c, values=values[c.name]) for c in curves.channels))


def renamed(curves, holds, name):
    """Curves in which a channel holds the values of another one."""
    values = next(c.values for c in curves.channels if c.name == holds)
    return changed(curves, (name,), lambda v: values)


def low_passed(values, cutoff=3.0, cycles=2):
    """Values through a low-pass filter of first order, by their Fourier series."""
    orders = np.fft.rfftfreq(values.size, cycles / values.size)
    return np.fft.irfft(np.fft.rfft(values) / (1.0 + 1j * orders / cutoff), values.size)


def butterworth(values, cutoff=2.5, cycles=2):
    """Values through an analogue Butterworth filter of second order of scipy, at mesh orders."""
    numerator, denominator = scipy.signal.butter(2, cutoff, analog=True)
    orders = np.fft.rfftfreq(values.size, cycles / values.size)
    gains = scipy.signal.freqs(numerator, denominator, orders)[1]
    return np.fft.irfft(np.fft.rfft(values) * gains, values.size)


def butterworth_of_fourth_order(values, cutoff=2.5, cycles=2):
    """Values through an analogue Butterworth filter of fourth order of scipy, at mesh orders."""
    numerator, denominator = scipy.signal.butter(4, cutoff, analog=True)
    orders = np.fft.rfftfreq(values.size, cycles / values.size)
    gains = scipy.signal.freqs(numerator, denominator, orders)[1]
    return np.fft.irfft(np.fft.rfft(values) * gains, values.size)


def butterworth_both_ways(values, cutoff=2.5, cycles=2):
    """Values through a Butterworth filter of second order, forward and backward: gain 1/(1 + (m/c)^4)."""
    orders = np.fft.rfftfreq(values.size, cycles / values.size)
    return np.fft.irfft(np.fft.rfft(values) / (1.0 + (orders / cutoff) ** 4), values.size)


def high_passed(values, cutoff=0.7, cycles=2):
    """Values through a high-pass filter of first order, with their mean."""
    orders = np.fft.rfftfreq(values.size, cycles / values.size)
    gains = np.ones(orders.size, dtype=complex)
    gains[1:] = 1j * orders[1:] / (1j * orders[1:] + cutoff)
    return np.fft.irfft(np.fft.rfft(values) * gains, values.size)


def averaged(values, window=0.15, cycles=2):
    """Values through a moving average over a window [mesh cycles], as a circular sum."""
    half = round(0.5 * window * values.size / cycles)
    return np.mean([np.roll(values, shift) for shift in range(-half, half + 1)], axis=0)


def three_orders(values, cycles=2):
    """The mean and the first three mesh orders of values."""
    waves = np.fft.rfft(values)
    waves[3 * cycles + 1 :] = 0.0
    return np.fft.irfft(waves, values.size)


#: Channels along and across the line of action.
AXES = (("x_p", "y_p"), ("bearing_force_x_p", "bearing_force_y_p"))


def turned(curves, degrees, *axes):
    """Curves whose axes are turned by an angle from the line of action: a rotation by hand."""
    values = {channel.name: channel.values for channel in curves.channels}
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    for x, y in axes:
        values[x], values[y] = cosine * values[x] - sine * values[y], sine * values[x] + cosine * values[y]
    return replace(curves, channels=tuple(replace(c, values=values[c.name]) for c in curves.channels))
