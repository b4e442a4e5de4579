"""The potential-energy stiffness beside ISO 6336-1 method B, and where their difference comes from.

With k_max the largest stiffness of a pair and k_mean its mean over the path of contact, the ratio of the mean
mesh stiffnesses splits exactly into two factors:

    eps k_mean / (c_gamma b) = (k_max / (c' b)) * ((eps k_mean / k_max) / (0.75 eps + 0.25)),

the size of the stiffness and the shape of its curve over the path, for which the standard has one straight
line in the contact ratio. The size is further traced by changing one assumption at a time: linearised
contact, and the load, on which the standard's c' does not depend between 100 and 1600 N/mm while the contact
softens as its logarithm.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lumped.gear_geometry.geometry import Geometry
from lumped.labelling import labelled_dataset
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.stiffness import iso6336
from lumped.stiffness.energy import Contact, energy_curve, foundation_violations

if TYPE_CHECKING:
    import xarray as xr

#: Ends of the range in which the standard's c' does not depend on the load [N/mm].
LOADS = (iso6336.LOW_LOAD, 1600.0)


def iso_comparison(pair: AnyPair) -> xr.Dataset:
    """Energy stiffness over ISO 6336-1's, as the pair is and with one assumption changed at a time.

    Parameters
    ----------
    pair : a validated gear pair, whatever its own stiffness model

    Returns
    -------
    xarray.Dataset over ``variant``: ``mean_ratio``, energy over ISO mean mesh stiffness, and its factors
    ``single_ratio`` (largest pair stiffness over c') and ``shape_ratio`` [1]; the attributes carry c' and
    c_gamma times face width, ``iso_single`` and ``iso_mean`` [N/m], and ``range_warnings``

    Raises
    ------
    ParameterError : the rack cannot cut these teeth
    NumericalError : the strain energy did not converge
    """
    pair = load_gear_pair(pair)
    g = pair.geometry
    top, mean = iso6336.single_of(pair), iso6336.mean_of(pair)
    low, high = (pair.with_(operating__pinion_torque=_torque(load, g)) for load in LOADS)
    variants: dict[str, tuple[GearPair, Contact]] = {
        "as given": (pair, "weber_banaschek"),
        f"{LOADS[0]:g} N/mm": (low, "weber_banaschek"),
        f"{LOADS[1]:g} N/mm": (high, "weber_banaschek"),
        "linearised contact": (pair, "linear"),
    }
    xi = np.linspace(g.L_XA, g.L_XD, 402)[1:-1]
    found = []
    for one, contact in variants.values():
        curve = energy_curve(one, contact)
        found.append((curve.mean() * g.contact_ratio / mean, float(curve(xi).max()) / top))
    means, singles = (np.array(column) for column in zip(*found, strict=True))

    return labelled_dataset(
        {
            "mean_ratio": ("variant", means, "1", "mean mesh stiffness, energy over ISO 6336-1"),
            "single_ratio": ("variant", singles, "1", "largest stiffness of a pair, energy over ISO 6336-1"),
            "shape_ratio": (
                "variant",
                means / singles,
                "1",
                "mean over largest stiffness, energy over ISO 6336-1",
            ),
        },
        {"variant": (list(variants), "1", "assumption")},
        {
            "pair": pair.name,
            "iso_single": top,
            "iso_mean": mean,
            "range_warnings": [str(v) for v in (*foundation_violations(pair), *iso6336.fit_violations(pair))],
        },
    )


def _torque(load: float, g: Geometry) -> float:
    """Pinion torque [N m] of a tangential load per face width [N/mm] on the reference circle."""
    return load * 1e3 * g.face_width * g.reference_radius_pinion
