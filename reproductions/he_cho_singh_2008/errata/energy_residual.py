"""The energy residual of the equations of this class of models.

Sources: docs/theory/contact_energy.md; Oh, Grosh and Barber, J. Vib. Acoust. 127 (2005) 208.
"""

from __future__ import annotations

import numpy as np

import multibody
from lumped import GearPair
from lumped.model.periodic_system import periodic_system
from lumped.model.powers import mean_powers
from lumped.model.steady import PeriodicSolution, periodic_solution
from reproductions.he_cho_singh_2008.errata.stated import stated
from reproductions.he_cho_singh_2008.records import Erratum


def erratum_3(pair: GearPair) -> Erratum:
    """Equation 3: a contact force without a potential."""
    smooth = pair.with_({"friction.law": "none"})
    printed, repaired = (_motion(smooth.with_({"mesh.contact": form})) for form in ("prescribed", "loaded"))
    g = pair.geometry
    powers = mean_powers(printed)
    brake = printed.brake_torque * g.omega_gear
    paid = mean_powers(repaired)
    return stated(
        "3",
        {
            "lost": powers.lost,
            "driving": powers.driving,
            "energy_residual": mean_powers(_motion(pair)).energy_residual,
            "efficiency_printed": brake / powers.driving,
            "efficiency_repaired": paid.efficiency,
            "missing_printed": powers.driving - brake - powers.lost,
            "missing_repaired": _missing(smooth.with_({"mesh.contact": "loaded"})),
        },
    )


def _missing(pair: GearPair) -> float:
    """Mean power that the exact contact with an energy leaves out of the books over a mesh cycle [W]."""
    books = multibody.power_balance(pair, 1, initial="periodic", rtol=1e-10)
    taken = books.braking + books.friction + books.bearings + books.mesh_damping
    return (books.driving - books.kinetic - books.mesh_elastic - taken) / pair.geometry.mesh_period


def _motion(pair: GearPair) -> PeriodicSolution:
    return periodic_solution(periodic_system(pair, "full"), np.zeros(1), estimate_error=False)
