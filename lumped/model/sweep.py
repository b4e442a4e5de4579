"""Periodic motion of a gear pair over pinion speed, at given speeds or where its curves bend.

Sources: docs/theory/equations.md, "Periodic motion and the brake torque".
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import real_numbers
from lumped.display.progress import reported_to, shows_progress
from lumped.errors import NumericalError
from lumped.labelling import labelled_dataset, provenance
from lumped.model.averaged import modes
from lumped.model.linear_or_unilateral import ContactArgument, MotionForm, motion_form
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import LTVSystem, Supports, supports_of
from lumped.model.powers import balance
from lumped.model.results import farthest_reversal, load_range
from lumped.model.steady import solutions_over_speed
from lumped.model.steady_state import periodic_motion
from lumped.path_of_contact import friction_path_function
from lumped.ranges import warned_once
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, Progress, ProgressRequest

if TYPE_CHECKING:
    import xarray as xr

#: Curves that the speeds shall resolve; each group is drawn on one axis.
_DRAWN = (("dte_peak_to_peak",), ("normal_load_max", "normal_load_min"))
#: Largest distance between the curve and the straight line through two neighbours, over the height of the
#: axis.
_TOLERANCE = 0.003
#: Least distance of two speeds over the speed.
_FINEST = 1e-4
#: Least distance of two of the first speeds over the speed: no resonance is narrower.
_APART = 3e-3
#: Mesh orders that may excite a natural frequency at one of the first speeds.
_ORDERS = 6
#: Share of the speeds that are chosen before the curves are known.
_FIRST = 0.3


@shows_progress("speed sweep")
@warned_once()
def speed_sweep(
    pair: AnyPair,
    speeds_rpm: Iterable[float],
    *,
    contact: ContactArgument = "linear",
    supports: Supports | None = None,
    samples_per_cycle: int = 128,
    progress: ProgressRequest = None,
) -> xr.Dataset:
    """Periodic motion over pinion speed, with the teeth and on the shafts that the pair has.

    Parameters
    ----------
    pair : a validated gear pair; its speed is replaced
    speeds_rpm : pinion speeds [rpm], positive
    contact, supports : as of `lumped.steady_state`
    samples_per_cycle : times per cycle; peak to peak takes in extremes between them
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``speed`` [rpm]: peak-to-peak and root mean square (about the mean) of the
    transmission error and the translations, largest and smallest normal load (``results.load_range``),
    ``sliding_reversal``, largest distance from the pitch point at which a loaded pair slides against its
    nominal direction, mesh efficiency, and ``spectral_radius``, above 1 where the motion is unstable. A speed
    without periodic motion is NaN with ``periodic`` False.

    Raises
    ------
    ParameterError : a speed or the number of samples is out of range, before any work starts
    """
    progress = reported_to(progress)
    pair = load_gear_pair(pair)
    form = motion_form(pair, contact)
    supports = supports_of(pair, supports)
    speeds = running_speeds(speeds_rpm)
    pairs = [pair.with_({"operating.pinion_speed": float(rpm)}) for rpm in speeds]
    names = ("dte", "x_p", "x_g", "y_p", "y_g")
    table = {f"{n}_{kind}": np.full(speeds.size, np.nan) for n in names for kind in ("peak_to_peak", "rms")}
    table |= {
        n: np.full(speeds.size, np.nan)
        for n in (
            "normal_load_max",
            "normal_load_min",
            "sliding_reversal",
            "mesh_efficiency",
            "spectral_radius",
        )
    }
    periodic = np.zeros(speeds.size, dtype=bool)
    if form is MotionForm.LINEAR_LIKE_TEETH:
        motions = _linear_motions(pairs, supports, samples_per_cycle)
    else:
        motions = _motions(pairs, contact, supports, samples_per_cycle)
    for j, motion in enumerate(motions):
        if progress is not None:
            progress((j + 1) / speeds.size)
        if motion is None:
            continue
        periodic[j] = True
        run, numbers = motion
        for name in names:
            table[f"{name}_peak_to_peak"][j] = numbers[f"{name}_peak_to_peak"]
            table[f"{name}_rms"][j] = np.std(run[name])
        loads = load_range(pair, run["normal_load"], run["contact"])
        table["normal_load_max"][j] = loads[0]
        table["normal_load_min"][j] = loads[1]
        table["sliding_reversal"][j] = _reversal(run, pair.geometry.L_XP)
        for name in ("mesh_efficiency", "spectral_radius"):
            table[name][j] = numbers[name]
    variables = {name: ("speed", values, *_label(name)) for name, values in table.items()}
    return labelled_dataset(
        variables | {"periodic": ("speed", periodic, "1", "whether a periodic motion exists")},
        {"speed": (speeds, "rpm", "pinion speed")},
        provenance(pair)
        | {
            "model": "lumped",
            "contact": contact,
            "supports": supports,
            "teeth": "alike" if pair.healthy is pair else "as given",
        },
    )


#: A periodic motion: variables of ``VARIABLES``, and numbers of the attributes of ``steady_state``.
_Motion = tuple[Mapping[str, FloatArray], Mapping[str, float]]


def _linear_motions(pairs: Iterable[GearPair], supports: Supports, samples: int) -> Iterator[_Motion | None]:
    """Yield the linear motions of like teeth; None at a speed without periodic motion."""
    for solution in solutions_over_speed(systems_over_speed(pairs, supports), samples):
        if solution is None:
            yield None
            continue
        numbers = {f"{name}_peak_to_peak": value for name, value in solution.peak_to_peak.items()}
        numbers |= {"spectral_radius": solution.spectral_radius}
        yield solution.values, numbers | {"mesh_efficiency": balance(solution)["mesh_efficiency"]}


def _motions(
    pairs: Iterable[GearPair], contact: ContactArgument, supports: Supports, samples: int
) -> Iterator[_Motion | None]:
    """Yield the motions of `periodic_motion`; None at a speed without periodic motion."""
    for pair in pairs:
        try:
            motion = periodic_motion(pair, contact, supports, samples)
        except NumericalError:
            yield None
            continue
        yield motion.values, motion.attributes


def _label(name: str) -> tuple[str, str]:
    """Unit and plain name of a variable of the sweep."""
    ratio = name in ("mesh_efficiency", "spectral_radius")
    unit = "1" if ratio else "N" if name.startswith("normal") else "m"
    return unit, name.replace("_", " ").replace("dte", "transmission error")


def systems_over_speed(
    pairs: Iterable[GearPair], supports: Supports = "springs", *, warn: bool = True
) -> Iterator[LTVSystem]:
    """Yield the systems of pairs that differ in speed alone. Only the friction law changes with the speed.

    ``warn``: whether to warn at every speed of friction laws outside their range, or at the first speed only.
    """
    system: LTVSystem | None = None
    for pair in pairs:
        if system is None:
            system = LTVSystem.of(pair, "full", supports=supports)
        else:
            elements = system.cycle.elements
            friction = friction_path_function(pair, interval=elements.stiffness.interval, warn=warn)
            elements = replace(elements, friction=friction)
            system = system.at_speed(pair, MeshCycle(pair.geometry, elements))
        yield system


def _reversal(run: Mapping[str, FloatArray], pitch_point: float) -> float:
    """Largest distance from the pitch point at which a loaded pair slides backwards [m], or 0."""
    loaded = (run["contact"] > 0) & (run["normal_load"] > 0)
    return farthest_reversal(run["position"] - pitch_point, run["sliding_velocity"], loaded)


def running_speeds(speeds_rpm: Iterable[float]) -> FloatArray:
    """Return speeds [rpm] as an array, each checked to be positive and finite."""
    return real_numbers("speeds_rpm", speeds_rpm, 0.0, above=True, unit="rpm", action="Give running speeds.")


@warned_once()
def resolved_sweep(
    pair: GearPair,
    speeds_rpm: tuple[float, float],
    *,
    most: int = 240,
    samples_per_cycle: int = 128,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Periodic motion over a range of speeds, as ``speed_sweep``, at speeds that resolve its curves.

    The first speeds are the ends, the operating speed, those at which a mesh order meets a natural frequency,
    and others between, closer where the pair runs slowly. Intervals are then halved, the worst first, up to
    ``most`` speeds, as long as the straight line between two speeds is further from the curve than can be
    seen in a figure; its distance is estimated from second differences.
    """
    import xarray as xr

    new = _first_speeds(pair, speeds_rpm, max(int(_FIRST * most), 2))[:most]
    sweep: xr.Dataset | None = None
    done = 0
    while new.size:
        tell = None if progress is None else _part(progress, done / most, new.size / most)
        new_speeds = speed_sweep(pair, np.sort(new), samples_per_cycle=samples_per_cycle, progress=tell)
        sweep = new_speeds if sweep is None else xr.concat([sweep, new_speeds], "speed").sortby("speed")
        done = sweep.sizes["speed"]
        new = _halved(sweep)[: most - done]
    assert sweep is not None  # two speeds at least
    if progress is not None:
        progress(1.0)
    return sweep


def _part(progress: Progress, first: float, share: float) -> Progress:
    return lambda fraction, stage="", /: progress(first + share * fraction, stage)


def _first_speeds(pair: GearPair, ends: tuple[float, float], count: int) -> FloatArray:
    """Return speeds to begin with, by importance: ends, operating speed, resonances, and others between."""
    low, high = ends
    try:
        resonances = [mode.resonant_speed for mode in modes(pair)]
    except NumericalError:  # an overdamped mode has no natural frequency
        resonances = []
    places = np.divide.outer(resonances, np.arange(1, _ORDERS + 1)).T.ravel()
    # Resonances are wider the faster the pair runs, so steps grow with the root of speed.
    between = np.linspace(low**0.5, high**0.5, count)[1:-1] ** 2
    operating_speed = pair.operating.pinion_speed * 30.0 / np.pi
    wanted = np.concatenate([[low, high, operating_speed], places, between])
    speeds: list[float] = []
    for speed in wanted[(wanted >= low) & (wanted <= high)]:
        if all(abs(speed - other) > _APART * speed for other in speeds):
            speeds.append(float(speed))
    return np.array(speeds)


def _halved(sweep: xr.Dataset) -> FloatArray:
    """Middles of the intervals in which a straight line is too far from a curve, the worst first."""
    speed = sweep["speed"].to_numpy()
    distance = np.zeros(speed.size - 1)
    for group in _DRAWN:
        curves = np.stack([sweep[name].to_numpy() for name in group])
        if not np.isfinite(curves).any():
            continue
        height = float(np.nanmax(curves) - min(np.nanmin(curves), 0.0))
        for curve in curves:
            distance = np.maximum(distance, _straight_line_error(speed, curve) / (height or 1.0))
    not_too_close = np.diff(speed) > 2.0 * _FINEST * speed[1:]
    worst = np.argsort(-distance, kind="stable")
    worst = worst[(distance[worst] > _TOLERANCE) & not_too_close[worst]]
    return np.asarray(0.5 * (speed[worst] + speed[worst + 1]))


def _straight_line_error(x: FloatArray, y: FloatArray) -> FloatArray:
    """Estimated largest error of linear interpolation in each interval, |y''| h^2/8; 0 beside a gap.

    The curve is known on one side only of the first and the last interval: there it is taken twice.
    """
    step = np.diff(x)
    slope = np.diff(y) / step
    bend = np.nan_to_num(np.abs(np.diff(slope)) / (step[1:] + step[:-1]))  # |y''|/2 at the inner points
    ends = np.concatenate([2.0 * bend[:1], bend, 2.0 * bend[-1:]])
    return np.asarray(np.maximum(ends[1:], ends[:-1]) * step**2 / 4.0)
