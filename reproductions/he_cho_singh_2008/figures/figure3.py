"""Figure 3: laws I to IV, normalised, over one passage of a tooth pair."""

from __future__ import annotations

import numpy as np
import xarray as xr

from lumped import GearPair
from lumped.friction import mean_coefficient
from lumped.labelling import labelled_dataset
from lumped.path_of_contact import friction_path_function
from reproductions.he_cho_singh_2008.operating_points import FIGURE_4, LAWS
from reproductions.he_cho_singh_2008.records import FigureRecord, Number

_POINTS = 801


def normalised_laws(pair: GearPair) -> xr.Dataset:
    """mu(t)/mean|mu| of laws I to IV over 0 <= t/t_c < sigma, each by its own mean over the path of contact.

    The points are denser around the pitch point, with one just before and one just after it.
    """
    g = pair.geometry
    pitch = (g.L_XP - g.L_XA) / g.base_pitch
    offsets = np.geomspace(1e-6, 0.05, 60)
    cycles = np.unique(
        np.concatenate([np.linspace(0.0, g.contact_ratio, _POINTS)[:-1], pitch - offsets, pitch + offsets])
    )
    rows = []
    means = []
    for law in LAWS:
        mu = friction_path_function(pair, law=law)
        means.append(mean_coefficient(mu))
        rows.append(mu(g.L_XA + cycles * g.base_pitch) / means[-1])
    return labelled_dataset(
        {
            "normalised_mu": (("law", "cycles"), np.array(rows), "1", "friction coefficient over its mean"),
            "mean_mu": ("law", means, "1", "mean of |mu| over the path of contact"),
        },
        {"law": (list(LAWS), "1", "friction law"), "cycles": (cycles, "1", "t/t_c, mesh cycles since A")},
        {"contact_ratio": g.contact_ratio, "pitch": pitch},
    )


def figure3(pair: GearPair) -> FigureRecord:
    """Figure 3 with its data and numbers."""
    data = normalised_laws(FIGURE_4.of(pair))
    near = data["normalised_mu"].sel(cycles=data.attrs["pitch"] + 0.01, method="nearest")
    numbers = {f"{LAWS[law]}: mean of |mu|": Number(float(data["mean_mu"].sel(law=law))) for law in LAWS}
    numbers |= {
        f"{LAWS[law]}: |mu|/mean at 0.01 mesh cycles past P": Number(float(near.sel(law=law))) for law in LAWS
    }
    return FigureRecord(
        number="3",
        title="Friction laws I to IV, normalised",
        text=(
            f"mu over its own mean magnitude during one passage of a tooth pair, at {FIGURE_4.torque:g} N m "
            f"and {FIGURE_4.speed:g} rpm. The paper does not say by what it normalises; the mean of each law "
            "compares shapes."
        ),
        numbers=numbers,
        data={"normalised_laws": data},
    )
