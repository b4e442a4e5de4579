"""Craig-Bampton reduction of one field of a shaft: one coordinate kept exactly, and modes with it held.

Sources: R. R. Craig and M. C. C. Bampton, AIAA J. 6 (1968) 1313.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, solve

from lumped.errors import NumericalError
from lumped.typing import FloatArray

#: Largest change of a kept frequency from one order to the next but one, over the highest.
FREQUENCY_ERROR = 1e-6
#: Orders that are tried. Beyond the last, a shaft is too long beside the waves of its highest mode.
_FIRST_ORDER, _LAST_ORDER = 4, 24


@dataclass(frozen=True, eq=False)
class Reduced:
    """One field on few coordinates.

    Attributes
    ----------
    basis : (n, 1 + m) coordinates of the field from the kept one and m modal ones
    frequencies : (m,) of the modes with the kept coordinate held [rad/s]
    """

    basis: FloatArray
    frequencies: FloatArray


#: Order -> mass, stiffness and the number of the coordinate that is kept.
Matrices = Callable[[int], tuple[FloatArray, FloatArray, int]]


def reduce_fields(
    fields: Sequence[Matrices], highest: float, modal_masses: Sequence[float]
) -> tuple[tuple[Reduced, ...], int, float]:
    """Raise the order of all fields of a shaft until their kept modes stand, and reduce them.

    Parameters
    ----------
    fields : functions that make the matrices of each
    highest : modes above this are left out [rad/s]
    modal_masses : that of every mode of a field, so that modal coordinates have the size of the kept one

    Returns
    -------
    (reduced, order, error) : the fields, the order of the polynomials, and the largest change of a kept
        frequency by the last increase of the order, over the highest

    Raises
    ------
    NumericalError : the modes do not stand up to the last order
    """
    before = [_held(matrices(_FIRST_ORDER), highest)[0] for matrices in fields]
    for order in range(_FIRST_ORDER + 2, _LAST_ORDER + 1, 2):
        numbers = [matrices(order) for matrices in fields]
        found = [_held(one, highest) for one in numbers]
        change = [
            float(np.abs(old - new).max(initial=0.0)) / highest if old.size == new.size else np.inf
            for old, (new, _) in zip(before, found, strict=True)
        ]
        if max(change) < FREQUENCY_ERROR:
            reduced = (
                _reduced(one, frequencies, modes * math.sqrt(size))
                for one, (frequencies, modes), size in zip(numbers, found, modal_masses, strict=True)
            )
            return tuple(reduced), order, max(change)
        before = [frequencies for frequencies, _ in found]
    raise NumericalError(
        f"The modes of a shaft up to {highest / (2.0 * np.pi):.4g} Hz do not stand at order {_LAST_ORDER}: "
        "it is very long or thin. Shorten it, or make it thicker."
    )


def _held(numbers: tuple[FloatArray, FloatArray, int], highest: float) -> tuple[FloatArray, FloatArray]:
    """Frequencies up to the highest, and modes (n - 1, m), with the kept coordinate held."""
    mass, stiffness, kept = numbers
    inside = np.delete(np.arange(mass.shape[0]), kept)
    both = np.ix_(inside, inside)
    # Of the inverse problem the modes that are wanted are the largest: rounding by the smallest intervals, in
    # which vibration would be fastest, then stays in those that are not.
    inverse, modes = eigh(mass[both], stiffness[both], subset_by_value=(highest**-2, np.inf))
    frequencies = 1.0 / np.sqrt(inverse[::-1])
    return frequencies, modes[:, ::-1] * frequencies


def _reduced(
    numbers: tuple[FloatArray, FloatArray, int], frequencies: FloatArray, modes: FloatArray
) -> Reduced:
    """Static deflection under a unit displacement of the kept coordinate, beside the modes."""
    _, stiffness, kept = numbers
    inside = np.delete(np.arange(stiffness.shape[0]), kept)
    basis = np.zeros((stiffness.shape[0], 1 + frequencies.size))
    basis[kept, 0] = 1.0
    basis[inside, 0] = -solve(stiffness[np.ix_(inside, inside)], stiffness[inside, kept], assume_a="pos")
    basis[inside, 1:] = modes
    return Reduced(basis, frequencies)
