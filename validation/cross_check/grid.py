"""Regression grid: lumped against multibody over gear pairs, friction laws, stiffness, speeds and torques.

Every point compares two periodic motions, each with the brake torque that balances it. Two rules must hold:

- the same equations agree to the error of integration, as in the cross-check of a single pair;
- the law of torque: deflections are proportional to torque, and what they do to the geometry to its square.
  So the difference of the transmission error over its peak to peak falls fourfold with a quarter of the
  torque. A mistake in geometry, sign or load would not fall at all.
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
from lumped.errors import NumericalError, refuse
from lumped.friction import FRICTIONAL, LAWS
from lumped.labelling import Variable, labelled_dataset
from lumped.typing import FloatArray, Progress
from validation.cross_check.agreement import FIDELITIES, QUANTITIES, agreement
from validation.cross_check.motions import periodic_motion, unilateral_orbit
from validation.cross_check.verdict import limit_of
from validation.stop_signals import stopping_as_interrupt
from validation.studies.runner import compute, wanted
from validation.studies.store import Store, Table
from validation.studies.workers import workers_of

#: What can come of a point: both models were compared, the lumped one with contact loss where its linear
#: motion needs teeth that pull; or no such motion of one mesh cycle is stable.
COMPARED, CONTACT_LOST, NOT_COMPARED = STATES = ("compared", "compared, contact lost", "no stable motion")
_NUMBERS = ("status", "seconds", *(f"{fidelity}_{name}" for fidelity in FIDELITIES for name in QUANTITIES))
_ENERGY = {"model": "energy"}
#: Mesh of the grid -> fields of ``mesh``. "smooth" rises from zero over 2 mm and has no jump; loaded contact
#: has none either.
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
#: Laws whose coefficient does not depend on torque, so that the law of torque holds for them, and meshes
#: whose contact does not depend on it: with relief and loaded contact the length of contact does.
_CONSTANT_COEFFICIENT = tuple(name for name, law in LAWS.items() if law.coefficient)
_FIXED_CONTACT = ("rectangular", "parabolic", "energy", "smooth")
_COEFFICIENT = 0.05
#: Least fall of the difference over that of the torque. A mistake in geometry, sign or load does not fall at
#: all: a quarter where the torque falls to a quarter. Found are 0.57 to 2; where vibration turns the sliding
#: near the pitch point the length over which it does so grows with torque too.
LEAST_FALL = 0.5
AXES = ("preset", "law", "stiffness", "speed", "torque")
_RTOL = 1e-9


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
        """Values of every axis, in the order of ``AXES``."""
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
        if law in _CONSTANT_COEFFICIENT:  # by default it is the average of law II, which depends on torque
            changes["friction.coefficient"] = _COEFFICIENT
        return base.with_(changes)


def compare_point(pair: GearPair, samples: int) -> tuple[float, ...]:
    """Compare the models in periodic motion; the numbers that ``_NUMBERS`` names, status by its place.

    Raises
    ------
    SpurcheckError : a model fails
    """
    started = time.process_time()
    orbit, pulling = unilateral_orbit(pair)
    if pulling:
        nothing = [np.nan] * (len(FIDELITIES) * len(QUANTITIES))
        return (STATES.index(NOT_COMPARED), time.process_time() - started, *nothing)
    if orbit is None:
        reference = lumped.steady_state(pair, samples_per_cycle=samples)
    else:
        reference = orbit.sampled(samples)
    found = []
    for fidelity in FIDELITIES:
        run = periodic_motion(pair, fidelity, samples, _RTOL, orbit)
        if run is None:
            raise NumericalError(f"The multibody model has no periodic motion at fidelity '{fidelity}'.")
        for name in QUANTITIES:
            limit = limit_of(name, fidelity)
            found.append(agreement(pair, name, fidelity, run, reference, limit).difference)
    status = STATES.index(COMPARED if orbit is None else CONTACT_LOST)
    return (status, time.process_time() - started, *found)


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

        difference : largest difference, over ``agreement.Agreement.scale``
        limit : its limit in the cross-check of a pair, over fidelity and quantity
        status : out of ``STATES``, or why a model failed
        torque_law : fall of the exact transmission error's difference to the next lower torque, over the fall
            of the torque: 1 by the law of torque; NaN where it is not judged
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


def broken_rules(result: xr.Dataset) -> list[tuple[dict[str, str | float], str]]:
    """Coordinates of points where a rule is broken or a model failed, and in words what."""
    found = []
    linear = (result["difference"] / result["limit"]).sel(fidelity="linear").max("quantity").to_numpy()
    fall, status = result["torque_law"].to_numpy(), result["status"].to_numpy()
    for index in np.ndindex(status.shape):
        point = {axis: result[axis][place].item() for axis, place in zip(AXES, index, strict=True)}
        if status[index] not in STATES:
            found.append((point, str(status[index])))
        if linear[index] > 1.0:
            found.append((point, f"the same equations differ by {linear[index]:.3g} times the limit"))
        if fall[index] < LEAST_FALL:
            found.append((point, f"the difference falls {fall[index]:.3g} times as the torque does"))
    return found


class _GridCases:
    """The points of a grid, as cases of a store; see ``validation.studies.store.Cases``."""

    outputs = _NUMBERS

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
    outputs: ClassVar[tuple[str, ...]] = _NUMBERS
    nan_allowed: ClassVar[bool] = True

    def __call__(self, values: tuple[Any, ...]) -> tuple[float, ...]:
        return compare_point(self.grid.pair(*values), self.grid.samples)


def _dataset(g: Grid, table: Table) -> xr.Dataset:
    status, seconds, *columns = table.values.T
    words = [STATES[int(s)] if np.isfinite(s) else table.messages[case] for case, s in enumerate(status)]
    inner = ("fidelity", "quantity")
    shape = (*g.shape, len(FIDELITIES), len(QUANTITIES))
    difference = np.stack(columns, axis=-1).reshape(shape)
    limits = np.array([[limit_of(name, fidelity)[0] for name in QUANTITIES] for fidelity in FIDELITIES])
    states = np.array(words).reshape(g.shape)
    dte = difference[..., FIDELITIES.index("exact"), QUANTITIES.index("dte")]
    variables: dict[str, Variable] = {
        "difference": ((*AXES, *inner), difference, "1", "largest difference over peak to peak"),
        "limit": (inner, limits, "1", "limit of the difference"),
        "status": (AXES, states, "1", "what came of the point"),
        "torque_law": (AXES, _torque_law(g, dte, states), "1", "fall of the difference over that of torque"),
        "seconds": (AXES, seconds.reshape(g.shape), "s", "processor time of the point"),
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


def _torque_law(g: Grid, dte: FloatArray, states: np.ndarray[Any, np.dtype[np.str_]]) -> FloatArray:
    """Fall of the DTE's difference from each torque to the next over that of the torque, where judged."""
    torques, fall = np.asarray(g.torques), np.full(dte.shape, np.nan)
    fall[..., :-1] = dte[..., :-1] / dte[..., 1:] / (torques[:-1] / torques[1:])
    judged = states == COMPARED
    judged[..., :-1] &= judged[..., 1:]
    judged &= np.isin(g.laws, _CONSTANT_COEFFICIENT)[:, None, None, None]
    judged &= np.isin(g.stiffness, _FIXED_CONTACT)[:, None, None]
    return np.where(judged, fall, np.nan)
