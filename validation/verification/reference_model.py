"""Is the multibody model, which judges the lumped one, right itself? Evidence from outside their comparison.

Its damping by the decay of free vibrations, its bodies by their outlines, its equations of motion by a third
build whose bodies turn in exudyn's nodes, its machine by exudyn's own eigenvalues, its laws by published
values.

Sources: docs/theory/multibody.md, "What is own and what is shared", "Three builds of one machine".
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np

import multibody
from lumped import GearPair
from lumped.errors import NumericalError, ParameterError
from multibody.contact.drawing import circles
from multibody.study.shared import Shared, shared_of
from validation.verification.checks import Check, check
from validation.verification.published import PublishedValue, published_values, shown

if TYPE_CHECKING:
    import xarray as xr

T = TypeVar("T")

#: Mesh cycles of the third build.
_CYCLES = 2


@dataclass(frozen=True, eq=False)
class ReferenceModel:
    """What speaks for the multibody model.

    Attributes
    ----------
    shared : what it has in common with the lumped model, with other evidence for each
    published : every published formula at published numbers
    decays : free vibrations of the frozen mesh and of each body on its bearings
    blanks : bodies of pinion and gear by their outlines
    build : the machine built once more with bodies that turn
    modes : of the machine with frozen mesh, see ``multibody.frozen_modes``
    refused : why one of these is None, because it cannot be computed for this pair
    checks : what must hold
    """

    shared: tuple[Shared, ...]
    published: tuple[PublishedValue, ...]
    decays: tuple[multibody.Decay, ...] | None
    blanks: tuple[multibody.Blank, multibody.Blank] | None
    build: multibody.TurningBuild | None
    modes: xr.Dataset | None
    refused: tuple[str, ...]
    checks: tuple[Check, ...]

    @property
    def passes(self) -> bool:
        """Whether every check passes."""
        return all(check.passes for check in self.checks)


def reference_model(pair: GearPair, static_load: float) -> ReferenceModel:
    """Check the multibody model of a gear pair.

    Parameters
    ----------
    pair : a validated gear pair
    static_load : normal load of all tooth pairs at rest, as the report has it [N]
    """
    refused: list[str] = []

    def tried(what: str, compute: Callable[[], T]) -> T | None:
        try:
            return compute()
        except (NumericalError, ParameterError) as error:
            refused.append(f"{what}: {error}")
            return None

    published = published_values()
    decays = tried("free vibration", lambda: multibody.damping_check(pair))
    blanks = tried("outlines of the gears", lambda: multibody.blanks(pair))
    build = tried("third build", lambda: multibody.turning_build(pair, _CYCLES))
    modes = tried("natural frequencies with frozen mesh", lambda: multibody.frozen_modes(pair))
    checks = [shown(published), _static_load(pair, static_load)]
    if decays is not None:
        checks.append(_damping(decays))
    if build is not None:
        checks.append(_third_build(build))
    if modes is not None:
        checks += _modes(modes)
    return ReferenceModel(
        shared=shared_of(pair),
        published=published,
        decays=decays,
        blanks=blanks,
        build=build,
        modes=modes,
        refused=tuple(refused),
        checks=tuple(checks),
    )


def _static_load(pair: GearPair, static_load: float) -> Check:
    own = pair.operating.pinion_torque / circles(pair).base_pinion
    return check("static_load", abs(static_load / own - 1.0))


def _damping(decays: tuple[multibody.Decay, ...]) -> Check:
    return check("damping", max(abs(decay.measured - decay.given) for decay in decays))


def _third_build(build: multibody.TurningBuild) -> Check:
    return check("third_build", build.difference / build.span)


def _modes(modes: xr.Dataset) -> Iterator[Check]:
    frequency, damping = (modes[name] for name in ("natural_frequency", "damping_ratio"))

    def apart(own: str, other: str) -> float:
        return float(np.abs(frequency.sel(source=own) / frequency.sel(source=other) - 1.0).max())

    ratios = np.abs(damping.sel(source="exudyn linear") - damping.sel(source="lumped frozen"))
    yield check("frozen_modes", max(apart("exudyn linear", "lumped frozen"), float(ratios.max())))
    yield check("frozen_modes_exact", apart("exudyn exact", "lumped turned line"))
