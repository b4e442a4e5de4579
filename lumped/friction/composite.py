"""Law V: the law that the local film parameter asks for, equation (20)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from lumped.film import DEFAULT_THRESHOLDS, RANGES, regime
from lumped.friction import benedict_kelley, smoothed_coulomb, xu_kahraman
from lumped.friction.base import BoolArray, ContactPath, FrictionLaw, FrictionSettings
from lumped.validity import FloatArray


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
    """
    number = regime(film_parameter, thresholds)
    return np.asarray(
        np.select([number == 0, number == 1], [smoothed_coulomb, benedict_kelley], xu_kahraman),
        dtype=np.float64,
    )


def _signed(xi: FloatArray, path: ContactPath, settings: FrictionSettings) -> FloatArray:
    return composite(
        path.film_parameter(xi),
        smoothed_coulomb.LAW.signed(xi, path, settings),
        benedict_kelley.LAW.signed(xi, path, settings),
        xu_kahraman.LAW.signed(xi, path, settings),
        settings.thresholds,
    )


def _switches(path: ContactPath, settings: FrictionSettings) -> list[float]:
    changes = []
    for threshold in settings.thresholds[:2]:  # above the third one the law stays III
        changes += path.crossings(partial(_excess, path, threshold))
    laws = (smoothed_coulomb.LAW, benedict_kelley.LAW, xu_kahraman.LAW, xu_kahraman.LAW)
    inherited = [
        xi
        for number, law in enumerate(laws)
        for xi in law.switches(path, settings)
        if regime(path.film_parameter(np.array(xi)), settings.thresholds) == number
    ]
    return [*changes, *inherited]


def _parts(
    xi: FloatArray, path: ContactPath, settings: FrictionSettings
) -> list[tuple[FrictionLaw, BoolArray]]:
    number = regime(path.film_parameter(xi), settings.thresholds)
    return [
        (smoothed_coulomb.LAW, number == 0),
        (benedict_kelley.LAW, number == 1),
        (xu_kahraman.LAW, number >= 2),
    ]


def _excess(path: ContactPath, threshold: float, xi: FloatArray) -> FloatArray:
    return path.film_parameter(xi) - threshold


LAW = FrictionLaw(
    name="composite",
    title="V composite",
    signed=_signed,
    switches=_switches,
    ranges=(*benedict_kelley.RANGES, *xu_kahraman.RANGES, *RANGES),
    parts=_parts,
)
