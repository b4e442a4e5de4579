"""Compiled evaluation of path functions."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lumped.compiler import Compiler
from lumped.typing import BoolArray, FloatArray

compiled = Compiler([Path(__file__)])


@compiled
def laws_at(
    offsets: FloatArray,
    shift: FloatArray,
    contact: BoolArray,
    k_breaks: FloatArray,
    k_coefficients: FloatArray,
    c_breaks: FloatArray,
    c_coefficients: FloatArray,
    mu_breaks: FloatArray,
    mu_coefficients: FloatArray,
    e_breaks: FloatArray,
    e_coefficients: FloatArray,
    de_breaks: FloatArray,
    de_coefficients: FloatArray,
) -> FloatArray:
    """Five path functions (5, pairs, k) of all pairs where ``contact`` (pairs, k), zero elsewhere.

    Parameters
    ----------
    offsets : (pairs,) xi_i at the start of the cycle [m]
    shift : (k,) distance moved along the line of action [m]
    """
    values = np.zeros((5, offsets.size, shift.size))
    for pair in range(offsets.size):
        _law_along(k_breaks, k_coefficients, offsets[pair], shift, contact[pair], values[0, pair])
        _law_along(c_breaks, c_coefficients, offsets[pair], shift, contact[pair], values[1, pair])
        _law_along(mu_breaks, mu_coefficients, offsets[pair], shift, contact[pair], values[2, pair])
        _law_along(e_breaks, e_coefficients, offsets[pair], shift, contact[pair], values[3, pair])
        _law_along(de_breaks, de_coefficients, offsets[pair], shift, contact[pair], values[4, pair])
    return values


@compiled
def _law_along(
    breaks: FloatArray,
    coefficients: FloatArray,
    offset: float,
    shift: FloatArray,
    contact: BoolArray,
    values: FloatArray,
) -> None:
    """One of them for one pair; neighbours mostly lie on the same piece, which is tried first."""
    last, piece = breaks.size - 1, 0
    for i in range(shift.size):
        xi = offset + shift[i]
        if not contact[i] or not breaks[0] <= xi <= breaks[last]:
            continue
        if not (breaks[piece] <= xi and (xi < breaks[piece + 1] or piece == last - 1)):
            piece = min(np.searchsorted(breaks, xi, side="right"), last) - 1
        local = xi - breaks[piece]
        value = coefficients[0, piece]
        for power in range(1, coefficients.shape[0]):
            value = value * local + coefficients[power, piece]
        values[i] = value
