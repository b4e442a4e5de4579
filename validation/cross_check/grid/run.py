"""Regression grid: lumped against multibody over gear pairs, friction laws, stiffness, speeds and torques.

Every point compares two periodic motions, each with the brake torque that balances it. Two rules judge it:

- each quantity against its tolerance, ``validation.cross_check.tolerances``, as in the cross-check of a
  single pair; at fidelity "exact" that is what is left after the predicted effects of finite motions;
- the law of torque: deflections are proportional to torque, and what they do to the geometry to its square.
  So the difference of the transmission error over its peak to peak falls fourfold with a quarter of the
  torque. A mistake in geometry, sign or load would not fall at all, and noise would not fall regularly.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np
import xarray as xr

import lumped
from lumped import GearPair
from lumped.errors import refuse
from lumped.friction import FRICTIONAL, LAWS
from lumped.labelling import Variable, labelled_dataset
from lumped.typing import FloatArray, Progress
from validation.cross_check.agreement import FIDELITIES, QUANTITIES
from validation.cross_check.grid.point import (
    COMPARED,
    NUMBERS,
    SEPARATED,
    STATES,
    STICKING,
    compare_point,
)
from validation.stop_signals import stopping_as_interrupt
from validation.studies.runner import compute, wanted
from validation.studies.store import Store, Table
from validation.studies.workers import workers_of

__all__ = ["AXES", "COMPARED", "SEPARATED", "STICKING", "STIFFNESS", "Grid", "crosscheck_grid"]


_ENERGY = {"model": "energy"}
#: Mesh of the grid -> fields of ``mesh``; those not named are the paper's. "smooth" rises from zero over 2 mm
#: and has no jump; loaded contact has none either.
STIFFNESS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "rectangular": {"stiffness": {"model": "rectangular"}},
        "parabolic": {"stiffness": {"model": "parabolic"}},
        "energy": {"stiffness": _ENERGY},
        "smooth": {"stiffness": {"model": "parabolic", "ramp_length": 2.0}},
        "relief": {"stiffness": _ENERGY, "relief": "static"},
        "loaded": {"stiffness": _ENERGY, "contact": "loaded"},
        "loaded, relief": {"stiffness": _ENERGY, "contact": "loaded", "relief": "static"},
    }
)
#: What a mesh of the grid is where it says nothing.
_PLAIN = {"contact": "prescribed", "relief": "ignored"}
#: Laws whose coefficient does not depend on torque, so that the law of torque holds for them.
CONSTANT_COEFFICIENT = tuple(name for name, law in LAWS.items() if law.coefficient)
#: The law of torque is judged where the stiffness has no jump.
SMOOTH_STIFFNESS = ("smooth", "loaded", "loaded, relief")
_COEFFICIENT = 0.05
#: Allowed departure of the fall with torque from the expected one: what the expectation leaves out is of the
#: next order in torque, a share of the difference itself, which is some per cent at the presets' torques.
SCALING_TOLERANCE = 0.08
AXES = ("preset", "law", "stiffness", "speed", "torque")


@dataclass(frozen=True)
class Grid:
    """What is compared: every combination.

    Attributes
    ----------
    presets, laws : names of gear pairs and friction laws
    stiffness : keys of ``STIFFNESS``
    speeds, torques : shares of the preset's operating point; torques fall
    samples : output times per mesh cycle
    """

    presets: tuple[str, ...] = lumped.preset_names()
    laws: tuple[str, ...] = FRICTIONAL
    stiffness: tuple[str, ...] = tuple(STIFFNESS)
    speeds: tuple[float, ...] = (0.3, 1.0, 1.7)
    torques: tuple[float, ...] = (1.0, 1 / 4)
    samples: int = 128

    def __post_init__(self) -> None:
        for name, values in zip(AXES, self.axes, strict=True):
            if not values or len(set(values)) != len(values):
                raise refuse(f"grid.{name}", values, "at least one, each once", "Correct the list.")
        for name in set(self.stiffness) - set(STIFFNESS):
            raise refuse("grid.stiffness", name, f"out of {', '.join(STIFFNESS)}", "Choose among these.")
        if list(self.torques) != sorted(self.torques, reverse=True):
            raise refuse("grid.torques", self.torques, "falling", "Sort them from high to low.")

    @property
    def axes(self) -> tuple[tuple[Any, ...], ...]:
        """Values of every axis, in the order preset, law, stiffness, speed, torque."""
        return self.presets, self.laws, self.stiffness, self.speeds, self.torques

    @property
    def shape(self) -> tuple[int, ...]:
        """Points along every axis."""
        return tuple(map(len, self.axes))

    def pair(self, preset: str, law: str, stiffness: str, speed: float, torque: float) -> GearPair:
        """Gear pair of one point."""
        base = lumped.load_gear_pair(preset)
        changes: dict[str, Any] = {
            "friction.law": law,
            **{f"mesh.{field}": value for field, value in (_PLAIN | dict(STIFFNESS[stiffness])).items()},
            "operating.pinion_speed": speed * base.operating.pinion_speed * 30.0 / np.pi,
            "operating.pinion_torque": torque * base.operating.pinion_torque,
        }
        if law in CONSTANT_COEFFICIENT:  # by default it is the average of law II, which depends on torque
            changes["friction.coefficient"] = _COEFFICIENT
        return base.with_(changes)


def crosscheck_grid(
    grid: Grid | None = None,
    *,
    workers: int = 2,
    checkpoint: Path | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Compare the models at every point of a grid.

    Parameters
    ----------
    grid : points; default the full grid
    workers : processes; 0 computes in this process
    checkpoint : folder whose store keeps every finished point, so that an interrupted run goes on there;
        made if missing
    progress : called with the finished fraction

    Returns
    -------
    xarray.Dataset over preset, law, stiffness, speed, torque (shares of the preset's operating point),
    fidelity and quantity:

        difference, limit : judged metric and its tolerance, see ``validation.cross_check.tolerances``
        total : relative L2 of the whole difference, before anything predicted is taken off
        largest : largest difference over the peak to peak of the lumped motion
        status : "compared" (where the linear motion needs teeth that pull, with teeth that push only), "teeth
            separate" (no such motion of one mesh cycle is stable, and nothing is compared), "sliding may
            stick" (see ``validation.cross_check.finite_motion``; compared but not judged at fidelity
            "exact"), or why a model failed
        load_min : smallest normal load of the lumped model over the static load
        expected : largest change of the DTE that finite motions must make, over its peak to peak
        ratio : DTE difference over that at the next lower torque, divided by the ratio of the torques: 1 by
            the law of torque; NaN at the lowest
        ratio_expected : the same of the expected changes, which also know what follows the first order
        ratio_judged : whether that law must hold there: constant friction coefficient, smooth stiffness
        seconds : processor time of the point

    Attribute ``seconds`` is the wall time of this call, ``workers`` how many processes shared it, ``resumed``
    how many points came from the checkpoint.

    Raises
    ------
    ParameterError : the checkpoint belongs to another grid, or other code began it
    StoreError : it cannot be written, or another process writes to it; what it holds is kept
    """
    g = grid or Grid()
    started = time.perf_counter()
    if checkpoint is not None:
        try:
            checkpoint.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            reason = error.strerror or type(error).__name__
            raise refuse("checkpoint", checkpoint, "a folder that can be written", f"{reason}.") from None
    cases = _GridCases(g)
    with (
        stopping_as_interrupt(),
        workers_of(workers, None, None, None) as (submit, slots),
        Store(checkpoint, cases) as store,
    ):
        todo = wanted(store.table())

        def told(done: int, number: int, failed: int) -> None:
            if progress is not None:
                progress((cases.count - number + done) / cases.count)

        compute(cases, _GridEvaluator(g), store, todo, submit, slots, progress=told)
        table = store.table()
    resumed = cases.count - int(np.count_nonzero(todo))
    result = _dataset(g, table)
    seconds = time.perf_counter() - started
    result.attrs |= {"seconds": seconds, "workers": workers, "resumed": resumed}
    return result


class _GridCases:
    """The points of a grid, as cases of a store; see ``validation.studies.store.Cases``."""

    outputs = NUMBERS

    def __init__(self, grid: Grid) -> None:
        self.grid = grid
        self.definition = "cross-check grid\n" + json.dumps(asdict(grid))
        self.sha256 = sha256(self.definition.encode()).hexdigest()
        self.count = math.prod(grid.shape)

    def values(self, cases: Sequence[int]) -> list[tuple[Any, ...]]:
        """Preset, law, stiffness, speed and torque of points."""
        places = np.unravel_index(np.asarray(cases), self.grid.shape)
        columns = ([axis[i] for i in at] for axis, at in zip(self.grid.axes, places, strict=True))
        return list(zip(*columns, strict=True))


@dataclass(frozen=True)
class _GridEvaluator:
    """What computes a point; see ``validation.studies.workers.Evaluator``."""

    grid: Grid
    outputs: ClassVar[tuple[str, ...]] = NUMBERS
    nan_allowed: ClassVar[bool] = True

    def __call__(self, values: tuple[Any, ...]) -> tuple[float, ...]:
        return compare_point(self.grid.pair(*values), self.grid.samples).numbers()


def _dataset(g: Grid, table: Table) -> xr.Dataset:
    numbers: dict[str, FloatArray] = dict(zip(NUMBERS, table.values.T, strict=True))
    status = [
        STATES[int(state)] if np.isfinite(state) else table.messages[case]
        for case, state in enumerate(numbers["status"])
    ]

    def each(name: str) -> FloatArray:
        return numbers[name].reshape(g.shape)

    def every(name: str) -> FloatArray:
        columns = [numbers[f"{name}_{fidelity}_{q}"] for fidelity in FIDELITIES for q in QUANTITIES]
        return np.stack(columns, axis=-1).reshape(*g.shape, len(FIDELITIES), len(QUANTITIES))

    inner = (*AXES, "fidelity", "quantity")
    largest, expected = every("largest"), each("expected")
    dte = largest[..., FIDELITIES.index("exact"), QUANTITIES.index("dte")]
    variables: dict[str, Variable] = {
        "difference": (inner, every("judged"), "1", "judged metric of the difference"),
        "limit": (inner, every("limit"), "1", "tolerance of the judged metric"),
        "total": (inner, every("total"), "1", "relative L2 of the whole difference"),
        "largest": (inner, largest, "1", "largest difference over peak to peak"),
        "status": (AXES, np.array(status).reshape(g.shape), "1", "what came of the point"),
        "load_min": (AXES, each("load_min"), "1", "smallest normal load over static load, lumped"),
        "expected": (AXES, expected, "1", "largest expected DTE difference over peak to peak"),
        "ratio": (AXES, _ratios(g, dte), "1", "fall of the DTE difference, over that of the torque"),
        "ratio_expected": (AXES, _ratios(g, expected), "1", "expected fall over that of the torque"),
        "ratio_judged": (AXES, _ratio_judged(g), "1", "whether the law of torque must hold"),
        "seconds": (AXES, each("seconds"), "s", "processor time of the point"),
    }
    share = "share of the preset's "
    return labelled_dataset(
        variables,
        {
            "preset": (list(g.presets), "1", "gear pair"),
            "law": (list(g.laws), "1", "friction law"),
            "stiffness": (list(g.stiffness), "1", "stiffness model"),
            "speed": (list(g.speeds), "1", share + "speed"),
            "torque": (list(g.torques), "1", share + "torque"),
            "fidelity": (list(FIDELITIES), "1", "fidelity of the multibody model"),
            "quantity": (list(QUANTITIES), "1", "compared quantity"),
        },
        {"samples_per_cycle": g.samples},
    )


def _ratios(g: Grid, dte: FloatArray) -> FloatArray:
    """Fall of a difference of the DTE from each torque to the next, over the fall of the torque."""
    torques = np.asarray(g.torques)
    ratios = np.full(dte.shape, np.nan)
    ratios[..., :-1] = dte[..., :-1] / dte[..., 1:] / (torques[:-1] / torques[1:])
    return ratios


def _ratio_judged(g: Grid) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    constant = np.isin(g.laws, CONSTANT_COEFFICIENT)[:, None]
    smooth = np.isin(g.stiffness, SMOOTH_STIFFNESS)[None, :]
    return np.broadcast_to((constant & smooth)[None, :, :, None, None], g.shape).copy()
