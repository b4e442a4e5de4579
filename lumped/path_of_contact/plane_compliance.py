"""Compliances of all tooth pairs in contact over a mesh cycle, from plane elasticity of both gears.

Sources: docs/theory/elasticity.md; method and checks in ``lumped.elasticity``.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple, get_args

import numpy as np

from lumped.arguments import one_of, whole_number
from lumped.labelling import labelled_dataset, provenance
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.stiffness import iso6336
from lumped.stiffness.finite_elements import (
    ElasticTooth,
    Plane,
    Support,
    cross_compliance,
    elastic_teeth,
    pair_error,
    self_compliance,
)
from lumped.stiffness.foundation import thin_rims
from lumped.typing import FloatArray

if TYPE_CHECKING:
    import xarray as xr

#: Gauss points between two changes of the number of pairs.
_GAUSS = 12


def plane_compliance(
    pair: AnyPair, *, plane: Plane = "stress", support: Support = "free", phases: int = 64
) -> xr.Dataset:
    """Compliance matrix of the tooth pairs in contact over a mesh cycle, by plane finite elements.

    Involutes, fillets and bodies are those of the pair, the load of a tooth moves the next ones, and
    contacts are as wide as under the operating torque on a single pair. The first call for a gear takes
    a tenth of a second; the result is kept in the user's cache folder.

    Parameters
    ----------
    pair : a validated gear pair, whatever its own stiffness model
    plane : state of the bodies, "stress" for narrow gears, "strain" for wide ones
    support : what deflections count from: "free", the mean motion of the gear; "clamped", its bore;
        "untwisted", its bore, less the twist of the body between bore and root circle
    phases : positions per cycle, each in the middle of its interval

    Returns
    -------
    xarray.Dataset over ``phase`` [mesh cycles after a pair was at A], ``pair`` and ``loaded_pair``:
    ``compliance`` [m/N] of a pair by the load of another or its own, zero where one of them is outside A to
    D; ``position`` [m]; ``mesh_stiffness`` of all pairs with the same approach and ``mesh_stiffness_alone``,
    the sum of pairs that do not move each other [N/m]. Attributes: ``mean`` and ``mean_alone`` over the
    cycle and ``largest_alone`` of one pair [N/m], ISO 6336-1's ``iso_single`` and ``iso_mean`` times face
    width [N/m], ``relative_error`` of a pair's own compliance from a second mesh [-], and ``range_warnings``

    Raises
    ------
    ParameterError : a solid gear cannot be clamped at its bore
    NumericalError : the teeth cannot be meshed
    """
    pair = load_gear_pair(pair)
    g = pair.geometry
    one_of("plane", plane, get_args(Plane))
    one_of("support", support, get_args(Support))
    count = whole_number("phases", phases, 1, 100_000)
    teeth = elastic_teeth(pair, plane, support)
    phase = (np.arange(count) + 0.5) / count
    ahead = np.arange(g.pairs)
    sampled = _sampled(pair, teeth, phase)
    # The compliances are smooth between the phases at which a pair leaves contact.
    leaves = math.fmod(g.contact_ratio, 1.0)
    x, w = np.polynomial.legendre.leggauss(_GAUSS)
    nodes = np.concatenate([0.5 * leaves * (x + 1.0), leaves + 0.5 * (1.0 - leaves) * (x + 1.0)])
    weight = 0.5 * np.concatenate([leaves * w, (1.0 - leaves) * w])
    at_nodes = _sampled(pair, teeth, nodes)
    path = np.linspace(g.L_XA, g.L_XD, 201)
    return labelled_dataset(
        {
            "compliance": (
                ("phase", "pair", "loaded_pair"),
                sampled.compliance,
                "m/N",
                "approach of a tooth pair by a unit load on a pair",
            ),
            "position": (
                ("phase", "pair"),
                sampled.position,
                "m",
                "position from X along the line of action",
            ),
            "mesh_stiffness": ("phase", sampled.stiffness, "N/m", "mesh stiffness, pairs move each other"),
            "mesh_stiffness_alone": ("phase", sampled.stiffness_alone, "N/m", "mesh stiffness, pairs alone"),
        },
        {
            "phase": (phase, "1", "mesh cycles after a pair was at A"),
            "pair": (ahead, "1", "pitches ahead of the pair that was at A"),
            "loaded_pair": (ahead, "1", "pitches by which the loaded pair is ahead"),
        },
        provenance(pair)
        | {
            "plane": plane,
            "support": support,
            "mean": float(weight @ at_nodes.stiffness),
            "mean_alone": float(weight @ at_nodes.stiffness_alone),
            "largest_alone": float(np.max(1.0 / self_compliance(pair, teeth, path))),
            "iso_single": iso6336.single_of(pair),
            "iso_mean": iso6336.mean_of(pair),
            "relative_error": float(pair_error(pair, teeth, path).max()),
            "range_warnings": [str(violation) for violation in thin_rims(pair)],
        },
    )


class _Sampled(NamedTuple):
    """Tooth pairs at n phases.

    Attributes
    ----------
    compliance : (n, pairs, pairs) motion of each pair by a unit load on each pair [m/N]
    position : (n, pairs) xi [m]
    stiffness : (n,) of the mesh, where pairs move each other [N/m]
    stiffness_alone : (n,) of the mesh, without the motion by other pairs [N/m]
    """

    compliance: FloatArray
    position: FloatArray
    stiffness: FloatArray
    stiffness_alone: FloatArray


def _sampled(pair: GearPair, teeth: tuple[ElasticTooth, ElasticTooth], phase: FloatArray) -> _Sampled:
    """Return the tooth pairs at phases (n,)."""
    g = pair.geometry
    ahead = np.arange(g.pairs)
    xi = g.L_XA + (phase[:, None] + ahead) * g.base_pitch
    touching = xi < g.L_XD
    matrix = np.zeros((*xi.shape, g.pairs))
    for i in ahead:
        touches = touching[:, i]
        matrix[touches, i, i] = self_compliance(pair, teeth, xi[touches, i])
        for j in range(i):
            matrix[touches, i, j] = matrix[touches, j, i] = cross_compliance(
                pair, teeth, int(i) - j, xi[touches, j]
            )
    # A pair out of contact has no load: any compliance will do.
    regular = matrix + np.where(touching, 0.0, 1.0)[:, :, None] * np.eye(g.pairs)
    shares = np.linalg.solve(regular, touching[..., None].astype(float))
    alone = np.where(touching, np.diagonal(matrix, axis1=1, axis2=2), np.inf)
    return _Sampled(matrix, xi, shares[..., 0].sum(axis=1), (1.0 / alone).sum(axis=1))
