"""Prescribed and loaded contact of the same gear pair, against the exact contact with all effects.

Both forms of the lumped model are judged by the same motion: that of the multibody model whose contact has an
energy and follows from clearance. So prescribed contact is not judged by a model that shares its contact.

Sources: docs/theory/contact_energy.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

import lumped
import multibody
from lumped import GearPair
from lumped.model.powers import MeanPowers, mean_powers
from lumped.model.results import cycle_peak_to_peak
from lumped.model.steady import periodic_cycle

#: Form -> what it is in words.
FORMS = {"prescribed": "prescribed contact", "loaded": "loaded contact"}
#: Places of losses, attributes of ``MeanPowers`` -> words.
PLACES = {
    "sliding": "sliding",
    "tooth_dampers": "tooth dampers",
    "bearings": "bearings",
    "energy_residual": "energy residual",
}


@dataclass(frozen=True, eq=False)
class ContactForms:
    """One gear pair in both forms, and the exact contact.

    Attributes
    ----------
    own : the form of the pair itself, a key of ``FORMS``
    motions : form, and "exact" -> periodic motion at the same times
    powers : form -> mean powers
    """

    own: str
    motions: dict[str, xr.Dataset]
    powers: dict[str, MeanPowers]

    @property
    def difference(self) -> dict[str, float]:
        """Form -> how far it is `off`."""
        return {form: self.off(self.motions[form]) for form in FORMS}

    def off(self, motion: xr.Dataset) -> float:
        """Largest difference of a transmission error from the exact contact's, over that one's swing."""
        exact = self.motions["exact"]["dte"].to_numpy()
        return float(np.abs(motion["dte"].to_numpy() - exact).max() / np.ptp(exact))

    def spans(self, period: float) -> dict[str, float]:
        """Peak to peak of each motion's transmission error [m], from the mesh period [s]."""
        return {name: cycle_peak_to_peak(one, "dte", period) for name, one in self.motions.items()}


def contact_forms(pair: GearPair, samples: int = 256, exact: xr.Dataset | None = None) -> ContactForms:
    """Compare both forms with the exact contact, in periodic motion.

    Parameters
    ----------
    pair : a validated gear pair, in either form
    samples : times per mesh cycle
    exact : periodic motion with the exact contact at these times, where it is known already

    Raises
    ------
    NumericalError : a form has no such motion, or the exact contact none near it
    """
    pairs = {form: pair.with_({"mesh.contact": form}) for form in FORMS}
    motions = {form: lumped.steady_state(of, samples_per_cycle=samples) for form, of in pairs.items()}
    if exact is None:
        exact = multibody.steady_state(pairs["loaded"], samples_per_cycle=samples)
    motions["exact"] = exact
    solutions = {form: periodic_cycle(of, 8) for form, of in pairs.items()}
    powers = {form: mean_powers(solution) for form, solution in solutions.items()}
    return ContactForms(pair.mesh.contact, motions, powers)
