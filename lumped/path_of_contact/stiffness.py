"""Stiffness of the teeth: over the path of contact, by components, and in total over a mesh cycle.

Sources: each model names its own; docs/theory/mesh_physics.md, "Stiffness of a tooth pair".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import whole_number
from lumped.labelling import labelled_dataset, provenance
from lumped.path_function import PathFunction
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.stiffness import iso6336
from lumped.stiffness.energy import pair_compliance

if TYPE_CHECKING:
    import xarray as xr


#: Every factor on the stiffness k_i that a model gives: field of a file -> factor of a pair [-], positive.
#: Stiffness, contact and coupling of tooth pairs have it, in the multibody model too, which reads these
#: three. The stiffness of ISO 6336-1 in K_v and the components of the energy method are without it.
FACTORS: Mapping[str, Callable[[GearPair], float]] = MappingProxyType(
    {
        "mesh.stiffness_factor": lambda pair: pair.mesh.stiffness_factor,
    }
)
#: What is said of a stiffness without these factors.
WITHOUT_FACTORS = f"without {' and '.join(FACTORS)}"


def stiffness_factor(pair: GearPair) -> float:
    """Factor on the stiffness k_i of a tooth pair that the model gives: the product of all `FACTORS`."""
    return math.prod((factor(pair) for factor in FACTORS.values()), start=1.0)


def pair_stiffness(pair: GearPair) -> PathFunction:
    """Stiffness k_i(xi) of one tooth pair from A to D, by the pair's stiffness model [N/m]."""
    return pair.mesh.stiffness.curve(pair).scaled(stiffness_factor(pair))


def contact_softening(pair: GearPair) -> float:
    """Return D in 1/k(T) = 1/k(T_0) - D ln(T/T_0) of a pair [m/N]: the compliance falls with the load.

    `stiffness_factor` divides the compliance and so D.
    """
    return pair.mesh.stiffness.softening(pair) / stiffness_factor(pair)


def cross_compliances(pair: GearPair) -> tuple[PathFunction, ...]:
    """Return w_m(xi) [m/N], m = 1, 2, ...: how far a unit load on a pair moves the pair m pitches ahead."""
    return tuple(w.scaled(1.0 / stiffness_factor(pair)) for w in pair.mesh.stiffness.neighbours(pair))


def stiffness_components(pair: AnyPair, points: int = 201) -> xr.Dataset:
    """Components of the potential-energy stiffness over the path of contact, contact by Weber and Banaschek.

    The components are those of the method, without ``mesh.stiffness_factor`` and any other of `FACTORS`.
    These factors act on the stiffness of the model of the pair.

    Parameters
    ----------
    pair : a validated gear pair, whatever its own stiffness model
    points : positions from A to D

    Returns
    -------
    xarray.Dataset over ``position`` [m]: ``compliance`` [m/N] over ``component`` (contact, then bending,
    shear, axial, foundation of pinion and gear), their sum's inverse ``stiffness`` [N/m]; the attributes
    carry ISO 6336-1's single stiffness times face width, ``iso_single_stiffness`` [N/m], and the quadrature
    error
    """
    pair = load_gear_pair(pair)
    g = pair.geometry
    xi = np.linspace(g.L_XA, g.L_XD, whole_number("points", points, 2, 100_000))
    compliance = pair_compliance(pair, xi)
    parts = ("bending", "shear", "axial", "foundation")
    names = ["contact"] + [f"{part} {gear}" for gear in ("pinion", "gear") for part in parts]
    values = [
        compliance.hertz,
        *(getattr(tooth, part) for tooth in (compliance.pinion, compliance.gear) for part in parts),
    ]
    result = labelled_dataset(
        {
            "compliance": (
                ("component", "position"),
                np.stack(values),
                "m/N",
                "compliance along the line of action",
            ),
            "stiffness": ("position", compliance.stiffness, "N/m", "stiffness of a tooth pair"),
        },
        {
            "component": (names, "1", "part of the tooth pair"),
            "position": (compliance.position, "m", "position from X along the line of action"),
        },
        provenance(pair)
        | {
            "iso_single_stiffness": iso6336.single_of(pair),
            "quadrature_error": max(compliance.pinion.quadrature_error, compliance.gear.quadrature_error),
        },
    )
    for name in ("compliance", "stiffness"):
        result[name].attrs["note"] = f"of the method, {WITHOUT_FACTORS}"
    return result


def mesh_stiffness(pair: AnyPair, samples: int = 512) -> xr.Dataset:
    """Total mesh stiffness of the pair's stiffness model over one mesh cycle.

    Parameters
    ----------
    pair : a validated gear pair
    samples : phases per cycle, each in the middle of its interval

    Returns
    -------
    xarray.Dataset over ``phase`` [mesh cycles after a pair was at A] and ``pair``: ``pair_stiffness`` and
    ``mesh_stiffness`` [N/m]; the attribute ``mean`` is the exact mean and ``iso_mean`` ISO 6336-1's c_gamma
    times face width [N/m]
    """
    pair = load_gear_pair(pair)
    g = pair.geometry
    curve = pair_stiffness(pair)
    samples = whole_number("samples", samples, 1, 1_000_000)
    phase = (np.arange(samples) + 0.5) / samples
    ahead = np.arange(g.pairs)
    each = curve(g.L_XA + (phase[:, None] + ahead) * g.base_pitch)
    return labelled_dataset(
        {
            "pair_stiffness": (("phase", "pair"), each, "N/m", "tooth pair stiffness"),
            "mesh_stiffness": ("phase", each.sum(axis=1), "N/m", "total mesh stiffness"),
        },
        {
            "phase": (phase, "1", "mesh cycles after a pair was at A"),
            "pair": (ahead, "1", "pitches ahead of the pair that was at A"),
        },
        provenance(pair)
        | {
            "model": pair.mesh.stiffness.model,
            "mean": curve.mean() * g.contact_ratio,
            "iso_mean": iso6336.mean_of(pair),
        },
    )
