"""The coefficient mu_avg of laws I and IV: as given, else the mean of |mu| of law II from A to D.

A factor on mu_avg belongs into `average_coefficient`, and there only: laws I, IV and V, charts over speed and
the bound of `lumped.path_of_contact.friction.friction_misfit` read mu_avg from that function. A factor on mu
of every law is not in mu_avg, see ``ContactPath.friction_factor``.

Sources: Abbas Al-Zubaidi 2008, section 2.3 (docs/theory/friction.md, "The laws").
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from lumped.friction.base import ContactPath, FrictionLaw, FrictionSettings, fit_signed, mean_coefficient
from lumped.friction.benedict_kelley import LAW as BENEDICT_KELLEY

#: `FrictionLaw.average_slope` of a law whose |mu| is at most mu_avg: 1, and a quarter for the roundings of
#: the mean of law II.
AVERAGE_SLOPE = 1.25

#: `FrictionLaw.reads` of a law with mu_avg: names of what `average_coefficient` itself reads.
AVERAGE_READS = frozenset({"coefficient"})


def average_coefficient(path: ContactPath, settings: FrictionSettings) -> float:
    """Coefficient mu_avg [-] of laws I and IV.

    Without ``friction.coefficient`` the result must be proportional to `mean_of_law_two`: the bound on the
    error of mu rests on this.

    Parameters
    ----------
    path : the contact
    settings : parameters of the friction laws
    """
    return mean_of_law_two(path, settings) if settings.coefficient is None else settings.coefficient


def mean_of_law_two(path: ContactPath, settings: FrictionSettings) -> float:
    """Mean of |mu| of law II from A to D [-]; ``ContactPath.law_two_mean`` where the path states the mean.

    The mean is without ``ContactPath.friction_factor``: the law that reads the mean applies the factor.
    """
    if path.law_two_mean is not None:
        return path.law_two_mean
    return _computed_mean(without_factor(path), settings)


def without_factor(path: ContactPath) -> ContactPath:
    """The contact in which mu of every law is that of its formula."""
    return replace(path, friction_factor=1.0)


@lru_cache(maxsize=256)
def _computed_mean(path: ContactPath, settings: FrictionSettings) -> float:
    """Mean of |mu| of law II over the path [-]."""
    return mean_coefficient(fit_signed(BENEDICT_KELLEY, path, settings))


def longer_path(
    path: ContactPath, ends: tuple[float, float], law: FrictionLaw, settings: FrictionSettings
) -> ContactPath:
    """The contact from the first to the last position of loaded teeth; mu_avg stays the mean from A to D.

    Parameters
    ----------
    path : the nominal contact, from A to D
    ends : first and last position [m]
    law : the law that is evaluated on the longer path
    settings : parameters of the friction laws
    """
    longer = replace(path, L_XA=ends[0], L_XD=ends[1])
    if settings.coefficient is None and law.reads_average(longer, settings):
        return replace(longer, law_two_mean=mean_of_law_two(path, settings))
    return longer
