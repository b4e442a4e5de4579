"""Measured numbers of one channel beside those of a fit."""

from __future__ import annotations

from typing import NamedTuple

from lumped.typing import FloatArray


class Fitted(NamedTuple):
    """Measured and fitted numbers of one channel.

    Attributes
    ----------
    places : (k,) mesh orders, or speeds [rpm]
    measured, noise, fitted : (k,) amplitudes or values, standard deviations of the noise, those of the fit
    words, unit : plain name of the numbers, and their SI unit
    axis : plain name of the places
    """

    places: FloatArray
    measured: FloatArray
    noise: FloatArray
    fitted: FloatArray
    words: str
    unit: str
    axis: str
