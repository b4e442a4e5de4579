"""The friction laws by name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from lumped.arguments import one_of
from lumped.friction import benedict_kelley, composite, coulomb, smoothed_coulomb, xu_kahraman
from lumped.friction.base import FrictionLaw

_NONE = FrictionLaw(
    name="none",
    title="no friction",
    signed=lambda xi, path, settings: np.zeros_like(xi),
    switches=lambda path, settings: [],
    ranges=(),
)

#: Every law that ``friction.law`` may name, in the order of the paper.
LAWS: Mapping[str, FrictionLaw] = MappingProxyType(
    {
        law.name: law
        for law in (
            _NONE,
            coulomb.LAW,
            benedict_kelley.LAW,
            xu_kahraman.LAW,
            smoothed_coulomb.LAW,
            composite.LAW,
        )
    }
)


def law_named(name: str) -> FrictionLaw:
    """Return a law by name.

    Raises
    ------
    ParameterError : no law has this name
    """
    return LAWS[one_of("friction.law", name, LAWS)]
