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
from validation.verification.checks import Check
from validation.verification.published import PublishedValue, published_values, shown

if TYPE_CHECKING:
    import xarray as xr

T = TypeVar("T")

#: Mesh cycles of the third build.
_CYCLES = 3
_CALLED = "exudyn's natural frequencies of the machine with frozen mesh"


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
    return Check(
        key="static_load",
        subject="static load along the line of action in this report",
        exact="torque over the base radius that the multibody model draws; relative",
        value=abs(static_load / own - 1.0),
        limit=1e-12,
        reason="rounding",
    )


def _damping(decays: tuple[multibody.Decay, ...]) -> Check:
    return Check(
        key="damping",
        subject="free vibration of the frozen mesh, and of both bodies along and off the line of action",
        exact="decay with the damping ratios of the parameter file; difference of the ratios",
        value=max(abs(decay.measured - decay.given) for decay in decays),
        limit=1e-7,
        reason="runs at a relative tolerance of 1e-11 over two periods",
    )


def _third_build(build: multibody.TurningBuild) -> Check:
    return Check(
        key="third_build",
        subject="bodies that turn through their own angle in exudyn's nodes",
        exact="transmission error of the usual build in deviations; over its peak to peak",
        value=build.difference / build.span,
        limit=1e-4,
        reason="whole angles are integrated to 1e-8 rad, and steps straddle the jumps of the tooth forces",
    )


def _modes(modes: xr.Dataset) -> Iterator[Check]:
    frequency, damping = (modes[name] for name in ("natural_frequency", "damping_ratio"))

    def apart(own: str, other: str) -> float:
        return float(np.abs(frequency.sel(source=own) / frequency.sel(source=other) - 1.0).max())

    ratios = np.abs(damping.sel(source="exudyn linear") - damping.sel(source="lumped frozen"))
    yield Check(
        key="frozen_modes",
        subject=f"{_CALLED}, fidelity linear",
        exact="those of the lumped A(t) at this phase, relative, and its damping ratios, difference",
        value=max(apart("exudyn linear", "lumped frozen"), float(ratios.max())),
        limit=1e-6,
        reason="exudyn differentiates the forces numerically",
    )
    yield Check(
        key="frozen_modes_exact",
        subject=f"{_CALLED}, fidelity exact",
        exact="those of the lumped A(t) with the spring -N/L_XY of the turned line of action; relative",
        value=apart("exudyn exact", "lumped turned line"),
        limit=1e-3,
        reason="the contact stands beside its nominal place by a share of a base pitch of this size, where "
        "the stiffness is another; 1 % of a stiffness changes a frequency by five times as much",
    )
