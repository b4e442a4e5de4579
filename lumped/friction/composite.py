"""Law V: the law that the local film parameter asks for, equation (20).

Sources: Abbas Al-Zubaidi 2008, eq. 20, and the missing full-film case (docs/theory/friction.md).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import real_array
from lumped.friction.base import ContactPath, FrictionLaw, FrictionSettings
from lumped.friction.benedict_kelley import LAW as BENEDICT_KELLEY
from lumped.friction.smoothed_coulomb import LAW as SMOOTHED_COULOMB
from lumped.friction.xu_kahraman import LAW as XU_KAHRAMAN
from lumped.lubrication.film import DEFAULT_THRESHOLDS, RANGES, regime
from lumped.typing import BoolArray, FloatArray


def composite(
    film_parameter: ArrayLike,
    smoothed_coulomb: ArrayLike,
    benedict_kelley: ArrayLike,
    xu_kahraman: ArrayLike,
    thresholds: Sequence[float] = DEFAULT_THRESHOLDS,
) -> FloatArray:
    """Composite friction: law IV, II or III by film parameter, equation (20).

    Lambda below the first threshold: IV (boundary); up to the second: II (mixed); above it: III
    (elastohydrodynamic). The print has no case above the third threshold; a full film is III as well.

    Parameters
    ----------
    film_parameter : Lambda [-]
    smoothed_coulomb, benedict_kelley, xu_kahraman : mu of laws IV, II and III at the same positions, with
        their signs [-]
    thresholds : three increasing film parameters

    Returns
    -------
    mu [-]

    Examples
    --------
    >>> float(composite(2.0, 0.05, 0.06, 0.03))
    0.06
    """
    number = regime(film_parameter, thresholds)
    laws = {
        "smoothed_coulomb": smoothed_coulomb,
        "benedict_kelley": benedict_kelley,
        "xu_kahraman": xu_kahraman,
    }
    iv, ii, iii = (real_array(name, mu) for name, mu in laws.items())
    return np.asarray(np.select([number == 0, number == 1], [iv, ii], iii), dtype=np.float64)


def _signed(xi: FloatArray, path: ContactPath, settings: FrictionSettings) -> FloatArray:
    """``composite``, with each law evaluated only where it is in force."""
    positions = np.atleast_1d(xi)
    mu = np.empty_like(positions)
    for law, inside in _parts(positions, path, settings):
        if inside.any():
            mu[inside] = law.formula(positions[inside], path, settings)
    return mu.reshape(np.shape(xi))


def _switches(path: ContactPath, settings: FrictionSettings) -> list[float]:
    changes: list[float] = []
    for threshold in settings.thresholds[:2]:  # above the third one the law stays III
        changes += path.crossings(partial(_excess, path, threshold))
    edges = [path.L_XA, *sorted(changes), path.L_XD]
    inherited = [
        xi
        for low, high in itertools.pairwise(edges)
        for law, inside in _parts(np.array([0.5 * (low + high)]), path, settings)
        if inside.any()
        for xi in law.switches(path, settings)
        if low < xi < high
    ]
    return [*changes, *inherited]


def _parts(
    xi: FloatArray, path: ContactPath, settings: FrictionSettings
) -> list[tuple[FrictionLaw, BoolArray]]:
    number = regime(path.film_parameter(xi), settings.thresholds)
    return [(SMOOTHED_COULOMB, number == 0), (BENEDICT_KELLEY, number == 1), (XU_KAHRAMAN, number >= 2)]


def _excess(path: ContactPath, threshold: float, xi: FloatArray) -> FloatArray:
    return path.film_parameter(xi) - threshold


def _analytic(
    low: FloatArray, high: FloatArray, path: ContactPath, settings: FrictionSettings
) -> tuple[FloatArray, FloatArray]:
    ratio = np.empty_like(low)
    size = np.empty_like(low)
    for law, inside in _parts(0.5 * (low + high), path, settings):
        if inside.any() and law.analytic is not None:
            ratio[inside], size[inside] = law.analytic(low[inside], high[inside], path, settings)
    return ratio, size


#: What the film parameter, which decides the regime, and its limits depend on.
_OF_FILM = frozenset(
    {
        "thresholds",
        "effective_modulus",
        "viscosity",
        "pressure_viscosity_k",
        "pressure_viscosity_s",
        "composite_roughness",
        "film_length",
    }
)

LAW = FrictionLaw(
    name="composite",
    numeral="V",
    label="composite",
    formula=_signed,
    switches=_switches,
    ranges=(*BENEDICT_KELLEY.ranges, *XU_KAHRAMAN.ranges, *RANGES),
    parts=_parts,
    average_slope=max(law.average_slope for law in (BENEDICT_KELLEY, XU_KAHRAMAN, SMOOTHED_COULOMB)),
    reads=frozenset().union(
        _OF_FILM, *(law.reads or () for law in (BENEDICT_KELLEY, XU_KAHRAMAN, SMOOTHED_COULOMB))
    ),
    analytic=_analytic,
)
