"""Alterations of the error of a tooth pair over the path of contact: sign of the relief, one error for all.

Each function takes the element laws over xi and returns altered ones. Errors are positive where material is
missing.

Sources: docs/how_to/check_your_model.md, "Explanations"; docs/theory/mesh_physics.md for relief.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from lumped.mesh.unloaded import reliefs_at
from lumped.path_function import PathFunction
from lumped.quasi_static.elements import MeshElements, mean_of_pairs
from lumped.quasi_static.tooth_error import reliefs_of
from lumped.root_in_bracket import roots_in_brackets
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.explanations.pair_laws import TOLERANCE, marks_of, separate, total_of_pairs

CommonError = Literal["", "smallest", "mean", "newest pair", "mean stiffness"]
#: Places of the path of contact at which the pair with the smallest error is sought.
_PLACES = 801


def with_relief_signs(pair: GearPair, elements: MeshElements, pinion: float, gear: float) -> MeshElements:
    """Return element laws whose errors have the relief of each gear times a factor."""
    reliefs = reliefs_of(pair)
    of_pinion, of_gear = reliefs[reliefs["sense"] > 0.0], reliefs[reliefs["sense"] < 0.0]

    def error(xi: FloatArray) -> FloatArray:
        return np.asarray(pinion * reliefs_at(of_pinion, xi) + gear * reliefs_at(of_gear, xi))

    return _with_error(pair, elements, error)


def with_common_error(pair: GearPair, elements: MeshElements, kind: CommonError) -> MeshElements:
    """Return element laws in which all pairs in contact have one error e.

    smallest: min e_j. mean: SUM k_j e_j/K with the stiffness K of the mesh, so that the mesh force is right
    and the share of each pair is not. newest pair: the error of the pair that came into contact last. mean
    stiffness: mean(K) SUM e_j/K, so that the errors make the force mean(K) SUM e_j.
    """
    errors, stiffness = elements.error, elements.stiffness
    low, high = stiffness.interval
    pitch = pair.geometry.base_pitch
    total = total_of_pairs(pair, stiffness)
    mean = mean_of_pairs(stiffness, pitch)
    reach = int(np.ceil((high - low) / pitch))
    shifts = np.arange(-reach, reach + 1) * pitch

    def others(xi: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        places = np.add.outer(xi, shifts)
        inside = (places >= low) & (places < high)
        return np.asarray(errors(places)), np.where(inside, stiffness(places), 0.0), inside

    def error(xi: FloatArray) -> FloatArray:
        if kind == "newest pair":
            return errors(low + np.mod(xi - low, pitch))
        e, k, inside = others(xi)
        if kind == "smallest":
            return np.asarray(np.where(inside, e, np.inf).min(axis=-1))
        if kind == "mean":
            return np.asarray((k * e).sum(axis=-1) / total(xi))
        return np.asarray(mean * np.where(inside, e, 0.0).sum(axis=-1) / total(xi))

    marks = _changes(errors, low, high, pitch) if kind == "smallest" else np.empty(0)
    return _with_error(pair, elements, error, marks)


def _changes(errors: PathFunction, low: float, high: float, pitch: float) -> FloatArray:
    """Places at which two neighbouring pairs have the same error, and their copies on the path."""
    if high - low <= pitch:
        return np.empty(0)

    def difference(xi: FloatArray) -> FloatArray:
        return np.asarray(errors(xi) - errors(xi + pitch))

    inside = 1e-9 * pitch
    places = np.linspace(low + inside, high - pitch - inside, _PLACES)
    values = difference(places)
    changes = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    roots = roots_in_brackets(difference, places[changes], places[changes + 1], xtol=1e-16)
    reach = int(np.ceil((high - low) / pitch))
    return np.asarray(np.add.outer(roots, np.arange(-reach, reach + 1) * pitch).ravel())


def _with_error(
    pair: GearPair,
    elements: MeshElements,
    error: Callable[[FloatArray], FloatArray],
    further: FloatArray | None = None,
) -> MeshElements:
    """Element laws with another error of a tooth pair [m], with further places of its breaks."""
    low, high = elements.error.interval
    marks = marks_of(pair, (elements.error, elements.stiffness), low, high)
    marks = separate(np.append(marks, np.empty(0) if further is None else further), pair, low, high)
    size = float(np.abs(error(np.linspace(low, high, 401)[1:-1])).max())
    breaks = np.concatenate([[low], marks, [high]])
    law = PathFunction.fit(error, breaks, marks, tolerance=TOLERANCE * max(size, 1e-12))
    return replace(elements, error=law)
