"""Unstable zones of the one-degree-of-freedom pair with Coulomb friction, on a grid fine enough to draw.

``floquet.gear.vaishya_singh.stability_zones`` gives every node its error bound; here the closed form is
evaluated for whole rows at once.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from floquet.gear.vaishya_singh import CoulombGearPair
from lumped import GearPair
from lumped.errors import refuse

SPEED_RATIOS = np.linspace(0.3, 2.6, 921)
DAMPING_RATIOS = np.linspace(0.0, 0.1, 201)


def zones(pair: CoulombGearPair) -> xr.Dataset:
    """Spectral radius without friction, with friction that reverses, and with friction of one sign.

    Parameters
    ----------
    pair : its contact ratio, pressure angle and coefficient are used

    Returns
    -------
    Dataset over ``friction`` ("none", "reversing", "constant"), ``damping_ratio`` of the mean mesh and
    ``speed_ratio``, mesh frequency over the natural frequency of the mean mesh: ``spectral_radius``
    """
    cases = {
        "none": replace(pair, friction=0.0),
        "reversing": replace(pair, sign="reversing"),
        "constant": replace(pair, sign="constant"),
    }
    radius = np.array(
        [
            [
                np.abs(replace(case, damping_ratio=float(zeta)).multipliers(SPEED_RATIOS)[:, 0])
                for zeta in DAMPING_RATIOS
            ]
            for case in cases.values()
        ]
    )
    return xr.Dataset(
        {
            "spectral_radius": (
                ("friction", "damping_ratio", "speed_ratio"),
                radius,
                {"units": "1", "long_name": "spectral radius, closed form"},
            )
        },
        coords={
            "friction": np.array(list(cases), dtype=object),
            "damping_ratio": (
                "damping_ratio",
                DAMPING_RATIOS,
                {"units": "1", "long_name": "mesh damping ratio"},
            ),
            "speed_ratio": (
                "speed_ratio",
                SPEED_RATIOS,
                {"units": "1", "long_name": "mesh frequency over natural frequency of the mean mesh"},
            ),
        },
        attrs={
            "title": "stability zones of a pair with one degree of freedom and Coulomb friction",
            "friction_coefficient": pair.friction,
            "contact_ratio": pair.contact_ratio,
            "pressure_angle": float(np.rad2deg(pair.pressure_angle)),
        },
    )


def coulomb_gear_pair(pair: GearPair, friction: float) -> CoulombGearPair:
    """One-degree-of-freedom pair with the contact ratio and pressure angle of a gear pair.

    Parameters
    ----------
    pair : the gear pair, of unity ratio and contact ratio up to 2
    friction : coefficient

    Raises
    ------
    ParameterError : another ratio, for which friction does not only scale the stiffness
    """
    if pair.gear.teeth != pair.pinion.teeth:
        raise refuse(
            "gear.teeth",
            pair.gear.teeth,
            f"{pair.pinion.teeth}, as the pinion",
            "The closed form holds for unity ratio, for example --set gear.teeth=... or preset nasa_28_28.",
        )
    g = pair.geometry
    return CoulombGearPair(
        contact_ratio=g.contact_ratio, friction=friction, pressure_angle=g.operating_pressure_angle
    )
