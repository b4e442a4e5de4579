"""Static transmission error and load sharing over the mesh cycle and torque (Harris map).

S. L. Harris, Dynamic loads on the teeth of spur gears, Proc. Inst. Mech. Eng. 172 (1958) 87-112: curves of
static transmission error for a family of loads.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lumped.arguments import real_numbers, whole_number
from lumped.display.result import DisplayedResult
from lumped.errors import BeyondFlanksError, refuse
from lumped.labelling import labelled_dataset, provenance
from lumped.mesh.unloaded import couplings
from lumped.path_of_contact import pair_stiffness
from lumped.path_of_contact.stiffness import contact_softening
from lumped.quasi_static.contacts import contact_of
from lumped.quasi_static.load_sharing import neighbour_laws, share_load
from lumped.quasi_static.tooth_error import corner_gap, relief_error
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

if TYPE_CHECKING:
    import xarray as xr

#: Pairs are followed this fraction of a base pitch beyond A and D, where deflection lets them touch.
REACH = 0.45
#: Stiffness and error at the very ends of the path are taken this fraction of a base pitch inside it.
_INSIDE = 1e-12
#: Over the operating torque; below it the contact's compliance, which grows as the logarithm, is held.
_LEAST_TORQUE = 1e-6


@dataclass(frozen=True, repr=False)
class MeshPositions(DisplayedResult):
    """Tooth pairs over one mesh cycle, those near the path of contact included.

    Attributes
    ----------
    phase : (k,) mesh cycles since a pair was at A
    ahead : (pairs,) whole pitches by which a pair is ahead of the one that was at A
    xi : (k, pairs) positions from X [m]
    stiffness : (k, pairs) k_i, that of the nearest end of the path for a pair outside [N/m]
    error : (k, pairs) e_i, infinite where a pair cannot touch [m]
    coupling : (k, pairs, pairs) w_ij by which the load of a pair moves another, zero where pairs stand alone
        [m/N]
    """

    phase: FloatArray
    ahead: NDArray[np.int64]
    xi: FloatArray
    stiffness: FloatArray
    error: FloatArray
    coupling: FloatArray


def mesh_positions(pair: AnyPair, *, phases: int = 256, extended: bool | None = None) -> MeshPositions:
    """Stiffness and unloaded error of the tooth pairs over one mesh cycle.

    Parameters
    ----------
    pair : a validated gear pair
    phases : positions per mesh cycle, evenly spaced from a pair at A
    extended : whether deflection lets pairs touch before A and behind D; default True, and False with a
        stiffness of the whole mesh, which is used as given and has contact and profile in it

    Raises
    ------
    ParameterError : ``extended=True`` with a stiffness of the whole mesh
    """
    pair = load_gear_pair(pair)
    phases = whole_number("phases", phases, 2, 65536, "Give the number of positions per mesh cycle.")
    extended = _extended(pair, extended)
    g = pair.geometry
    reach = REACH if extended else 0.0
    ahead = np.arange(math.floor(-reach), math.ceil(g.contact_ratio + reach) + 1)
    phase = np.arange(phases) / phases
    xi = g.L_XA + (phase[:, None] + ahead) * g.base_pitch
    inside = _INSIDE * g.base_pitch
    k = pair_stiffness(pair)(np.clip(xi, g.L_XA + inside, g.L_XD - inside))
    e = corner_gap(g, xi)
    if not pair.mesh.stiffness.whole_mesh:
        e = e + relief_error(pair, np.clip(xi, g.L_XA, g.L_XD))
    margin = reach * g.base_pitch + inside
    apart = (xi < g.L_XA - margin) | (xi > g.L_XD + margin)
    return MeshPositions(
        phase,
        ahead,
        xi,
        np.where(apart, 0.0, k),
        np.where(apart, np.inf, e),
        couplings(neighbour_laws(contact_of(pair).neighbours(pair)), xi, ~apart),
    )


def static_transmission_error(
    pair: AnyPair, torques: ArrayLike | None = None, *, phases: int = 256, extended: bool | None = None
) -> xr.Dataset:
    """Quasi-static meshing of a gear pair: a Harris map and the load of every tooth pair.

    At each position the rigid approach delta and the loads N_i = k_i max(delta - e_i - sum_j w_ij N_j, 0)
    satisfy sum_i N_i = T/r_bp; w_ij is how far pairs move each other, where the stiffness model knows it and
    the mesh is with loaded contact. Stiffness with Weber and Banaschek's contact is taken at each torque;
    other stiffness does not depend on it. With a stiffness k of the whole mesh delta is T/(r_bp k).

    Parameters
    ----------
    pair : a validated gear pair
    torques : (n,) pinion torques >= 0 [N m]; default the operating torque
    phases, extended : as in ``mesh_positions``

    Returns
    -------
    xarray.Dataset over ``torque`` [N m], ``phase`` [mesh cycles] and ``pair``: ``transmission_error`` [m],
    ``peak_to_peak`` [m], ``normal_load`` [N], ``load_share`` [1], ``contact_ratio`` [1] under load,
    ``position`` [m] and ``error`` [m]

    Raises
    ------
    ParameterError : a negative torque, a relief that starts outside the active flank, or ``extended=True``
        with a stiffness of the whole mesh
    NumericalError : contact reaches further beyond the path than the pairs are followed
    """
    pair = load_gear_pair(pair)
    torques_or_default = pair.operating.pinion_torque if torques is None else torques
    torque = real_numbers("torques", torques_or_default, 0.0, unit="N m", action="Give driving torques.")
    g = pair.geometry
    mesh = mesh_positions(pair, phases=phases, extended=extended)
    force = torque / g.base_radius_pinion
    stiffness = _at_torques(mesh.stiffness, torque, pair)
    result = share_load(stiffness, mesh.error, force[:, None], mesh.coupling)
    _check_reach(mesh, result.load, g.L_XA, g.L_XD, g.base_pitch)
    te = result.transmission_error
    share = result.load / np.where(force > 0.0, force, np.inf)[:, None, None]  # no load, no share
    axes = ("torque", "phase", "pair")
    return labelled_dataset(
        {
            "transmission_error": (axes[:2], te, "m", "static transmission error, driven gear late"),
            "peak_to_peak": (axes[:1], np.ptp(te, axis=1), "m", "peak to peak static transmission error"),
            "normal_load": (axes, result.load, "N", "normal load of a tooth pair"),
            "load_share": (axes, share, "1", "share of a tooth pair in the load"),
            "contact_ratio": (
                axes[:1],
                (result.load > 0.0).sum(axis=2).mean(axis=1),
                "1",
                "mean number of loaded pairs",
            ),
            "position": (axes[1:], mesh.xi, "m", "position from X along the line of action"),
            "error": (axes[1:], mesh.error, "m", "unloaded error of a tooth pair"),
        },
        {
            "torque": (torque, "N*m", "pinion torque"),
            "phase": (mesh.phase, "1", "mesh cycles after a pair was at A"),
            "pair": (mesh.ahead, "1", "pitches ahead of the pair that was at A"),
        },
        provenance(pair) | {"extended_contact": int(_extended(pair, extended))},
    )


def _extended(pair: GearPair, extended: bool | None) -> bool:
    """Whether pairs are followed beyond A and D; a stiffness of the whole mesh has that contact in it."""
    whole_mesh = pair.mesh.stiffness.whole_mesh
    if whole_mesh and extended:
        allowed = "False where mesh.stiffness is that of the whole mesh"
        action = "Leave it out, or give the curve of one tooth pair: kind = 'pair' in mesh.stiffness."
        raise refuse("extended", True, allowed, action)
    return not whole_mesh if extended is None else bool(extended)


def _at_torques(stiffness: FloatArray, torque: FloatArray, pair: GearPair) -> FloatArray:
    """Stiffness of the pairs at every torque; (torques or 1, k, pairs) [N/m]."""
    softening = contact_softening(pair)
    if softening == 0.0:
        return stiffness[None]
    ratio = np.maximum(torque / pair.operating.pinion_torque, _LEAST_TORQUE)
    change = softening * np.log(ratio)[:, None, None]
    return np.asarray(stiffness / (1.0 - change * stiffness), dtype=np.float64)


def _check_reach(mesh: MeshPositions, load: FloatArray, low: float, high: float, pitch: float) -> None:
    near = 0.98 * REACH * pitch
    far = (mesh.xi < low - near) | (mesh.xi > high + near)
    if np.any(load[:, far] > 0.0):
        raise BeyondFlanksError(
            f"Teeth deflect so far that pairs touch {0.98 * REACH:.2f} base pitches outside the path of "
            "contact: lower the torque, check the stiffness, or set extended=False."
        )
