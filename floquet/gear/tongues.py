"""Tongues of instability of a gear pair over speed: predicted speeds, boundaries, what closes them.

Sources: docs/theory/floquet.md, "Where instability is, and what it is called".
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from floquet.engine.tongues import (
    Tongue,
    TongueTip,
    UnstableInterval,
    combinations,
    mode_shares,
    seeded_nodes,
    tongue_coordinates,
    tongue_tip,
    unstable_intervals,
)
from floquet.gear.axes import GEAR_AXES, GearVariation, checked_range, gear_grid, operating_rpm, vary
from floquet.gear.chart import label_variation, solved
from floquet.gear.multipliers import gear_block
from floquet.rank_one.batch import fast_monodromies, spectral_radii
from floquet.rank_one.system import RankOneSystem
from lumped.arguments import real_number, real_numbers, whole_number
from lumped.display.progress import reported_to, shows_progress
from lumped.display.result import DisplayedResult
from lumped.errors import NumericalError, refuse
from lumped.friction import mean_coefficient
from lumped.labelling import labelled_dataset, provenance
from lumped.model.periodic_system import Supports, on_springs
from lumped.path_of_contact.friction import coefficient_for, friction_path_function
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import LARGEST_SPEED, GearPair
from lumped.typing import ComplexArray, FloatArray, ProgressRequest

if TYPE_CHECKING:
    import xarray as xr

Radius = Callable[[npt.ArrayLike, npt.ArrayLike], FloatArray]
"""(pinion speeds [rpm], mesh damping ratios), broadcast -> spectral radii of the feedback block."""

#: Largest order k of the predicted lines (omega_i +- omega_j)/k that seed the search.
_ORDERS = 12
_RTOL = 1e-8
# As in floquet.engine.tongues: undamped bearings sit at 1 within rounding.
_THRESHOLD = 1e-9
_LARGEST_DAMPING = 1.0  # what the schema allows for a mesh
_SPEED_NODES = 400
_PAST = 0.1  # how far past the highest line its tongue may reach
_EDGE_ROWS = 25
_EDGE_SPEEDS = 49
_EDGE_ROUNDS = 14
_MOST = 20_000  # speeds of the grid of a search


def predicted_lines(
    pair: AnyPair | GearVariation, orders: int = 12, *, supports: Supports | None = None
) -> dict[Tongue, float]:
    """Pinion speeds [rpm] at which the mesh frequency is (omega_i +- omega_j)/k.

    omega are the natural frequencies of the time-averaged undamped feedback block, k = 1..orders.

    Parameters
    ----------
    pair : the gear pair
    orders : largest k
    supports : of a pair: "springs", its ``bearings``, or its "shafts"; by default the shafts if it has them
    """
    variation = GearVariation.of(pair, supports)
    orders = whole_number("orders", orders, 1, 1000)
    omega = gear_block(variation).modal().omega
    per_rpm = variation.pair.pinion.teeth * 2.0 * np.pi / 60.0  # mesh frequency [rad/s] per rpm
    return {
        Tongue(i + 1, j + 1, sign, k): float(total / k / per_rpm)
        for i, j, sign, total in combinations(omega)
        for k in range(1, orders + 1)
    }


@shows_progress("stability boundaries")
def stability_boundaries(
    pair: AnyPair,
    speed_rpm: tuple[float, float] = (500.0, 20000.0),
    axes: dict[str, npt.ArrayLike] | None = None,
    *,
    nodes: int = 400,
    orders: int = 12,
    xtol: float = 1e-8,
    rtol: float = 1e-9,
    supports: Supports | None = None,
    progress: ProgressRequest = None,
) -> xr.Dataset:
    """Boundaries, spectral radius = 1, of the tongues of instability over speed.

    Along speed the search starts from a grid that meets every tongue of a damped pair, of any order
    (`search_grid`). For pairs with hardly any damping a graded cluster of speeds at every predicted line
    (omega_i +- omega_j)/k is added. Bisection finds the ends of the tongues.

    Parameters
    ----------
    pair : the gear pair
    speed_rpm : range searched [rpm]
    axes : one more axis {name: values} out of `GEAR_AXES` other than speed, with the meaning that it has in
        `stability_chart`; default the pair as it is
    nodes : evenly spaced speeds of the search besides
    orders : largest k of the clusters
    xtol : relative accuracy of the boundaries
    rtol : of the monodromy matrices
    supports : "springs", the pair's ``bearings``, or its "shafts", where labels number the modes that count;
        by default the shafts of a pair that has them
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    Dataset over ``tongue`` (coordinates label, mode_i, mode_j, sign, order) and the axis: ``present``;
    ``lower`` and ``upper`` [rpm], the boundaries; ``peak`` [rpm] and ``peak_radius``; ``open_end``, whether
    the tongue runs out of the range. Where ``present`` is False the numbers are NaN. Where one label has
    several intervals at one value, lower and upper enclose them all, ``intervals`` counts them, and
    ``interval_lower`` and ``interval_upper`` over ``interval`` have them one by one. ``complete`` over the
    axis: whether the grid is as fine as the damping asks for; where it is not, thin tongues of orders above
    ``orders`` may be missing.

    Raises
    ------
    ParameterError : unusable range or axis
    """
    progress = reported_to(progress)
    base = GearVariation.of(pair, supports)
    low, high = checked_range("speed_rpm", speed_rpm)
    nodes = whole_number("nodes", nodes, 0, 1_000_000)
    xtol = real_number("xtol", xtol, 1e-15, 0.1)
    rtol = real_number("rtol", rtol, 1e-13, 1e-3)
    checked = gear_grid(axes, base.supports) if axes is not None else {}
    if axes is not None and (len(checked) != 1 or "speed_rpm" in checked):
        raise refuse("axes", ", ".join(checked), "one other than speed_rpm", "Scan other axes one at a time.")
    name, values = next(iter(checked.items())) if axes else ("value", np.array([np.nan]))
    intervals: dict[Tongue, dict[int, list[UnstableInterval]]] = {}
    complete = np.ones(values.size, dtype=bool)
    for index, value in enumerate(values):
        variation = vary(base, {name: float(value)} if axes else {})
        lines = np.array(list(predicted_lines(variation, orders).values()))
        dense, complete[index] = search_grid(gear_block(variation), low, high)

        def radius(speeds: FloatArray, variation: GearVariation = variation) -> FloatArray:
            return solved(variation, {"speed_rpm": speeds}, rtol).radius

        start = np.union1d(dense, seeded_nodes(lines, low, high, nodes))
        for interval in unstable_intervals(radius, start, xtol=xtol):
            label = label_variation(vary(variation, {"speed_rpm": interval.peak}))
            intervals.setdefault(label, {}).setdefault(index, []).append(interval)
        if progress is not None:
            progress((index + 1) / values.size)
    result = _boundaries_dataset(base, intervals, name, values, complete)
    return result if axes else result.isel({name: 0}, drop=True)


def search_grid(block: RankOneSystem, low: float, high: float) -> tuple[FloatArray, bool]:
    """Speeds so dense that every tongue of instability of any order raises the radius at one of them.

    Consider two modes near k Omega = omega_i + omega_j that decay with a and are coupled with strength g. At
    the detuning d = (k Omega - omega_i - omega_j)/2 the exponents are -a +- sqrt(g^2 - d^2) (Hsu 1963; the
    same for differences). They are unstable at some speed only if g > a. Let b <= a be the least decay of all
    modes. The larger exponent is then above the exponents of all other modes at least over |d| < b. Steps of
    b/omega_max put two speeds into this window.

    Returns the speeds, and whether the steps are as small as b/omega_max. The steps are larger where more
    than 20000 speeds would be needed.
    """
    needed = -float(block.mean_exponents().real.max()) / float(block.modal().omega.max())
    span = math.log(high / low)
    complete = needed * _MOST > span
    return np.geomspace(low, high, math.ceil(span / needed) + 1 if complete else _MOST), complete


def _boundaries_dataset(
    base: GearVariation,
    result: dict[Tongue, dict[int, list[UnstableInterval]]],
    name: str,
    values: FloatArray,
    complete: npt.NDArray[np.bool_],
) -> xr.Dataset:
    tongues = sorted(result)
    shape = (len(tongues), values.size)
    most = max((len(parts) for columns in result.values() for parts in columns.values()), default=0)
    interval_lower = np.full((*shape, most), np.nan)
    interval_upper = np.full((*shape, most), np.nan)
    lower = np.full(shape, np.nan)
    upper = np.full(shape, np.nan)
    peak = np.full(shape, np.nan)
    peak_radius = np.full(shape, np.nan)
    open_end = np.zeros(shape, dtype=bool)
    count = np.zeros(shape, dtype=np.int64)
    for row, tongue in enumerate(tongues):
        for column, parts in result[tongue].items():
            strongest = max(parts, key=lambda part: part.peak_radius)
            interval_lower[row, column, : len(parts)] = [part.lower for part in parts]
            interval_upper[row, column, : len(parts)] = [part.upper for part in parts]
            lower[row, column] = min(part.lower for part in parts)
            upper[row, column] = max(part.upper for part in parts)
            peak[row, column] = strongest.peak
            peak_radius[row, column] = strongest.peak_radius
            open_end[row, column] = any(part.open_below or part.open_above for part in parts)
            count[row, column] = len(parts)
    dims = ("tongue", name)
    each = ("tongue", name, "interval")
    axis = GEAR_AXES.get(name)
    return labelled_dataset(
        {
            "lower": (dims, lower, "rpm", "lower boundary of the tongue"),
            "upper": (dims, upper, "rpm", "upper boundary of the tongue"),
            "peak": (dims, peak, "rpm", "speed of the largest spectral radius in the tongue"),
            "peak_radius": (dims, peak_radius, "1", "largest spectral radius in the tongue"),
            "present": (dims, count > 0, "1", "tongue exists at this value"),
            "open_end": (dims, open_end, "1", "tongue runs out of the range searched"),
            "intervals": (dims, count, "1", "number of intervals of this label"),
            "interval_lower": (each, interval_lower, "rpm", "lower ends of the intervals"),
            "interval_upper": (each, interval_upper, "rpm", "upper ends of the intervals"),
            "complete": (name, complete, "1", "grid as fine as the damping asks for"),
        },
        {name: (values, axis.units, axis.long_name) if axis else (values, "1", "value")},
        {
            **provenance(base.pair),
            "title": f"stability boundaries of {base.pair.name}",
            "friction_law": base.pair.friction.law,
            "supports": base.supports,
        },
    ).assign_coords(tongue_coordinates("tongue", tongues))


def campbell(
    pair: AnyPair,
    speeds_rpm: npt.ArrayLike,
    *,
    mesh_orders: int = 6,
    orders: int = 6,
    rtol: float = 1e-9,
    supports: Supports | None = None,
) -> xr.Dataset:
    """Frequencies of the Floquet solutions over speed, against mesh orders and predicted tongues.

    The solutions are of the linear form with like teeth. A multiplier fixes a frequency only up to multiples
    of the mesh frequency. The mode shape decides which multiple: a solution belongs to the mode of the mean
    system in which the solution has the largest share of action, turning forwards. The frequency of the
    solution is the one nearest to the frequency of this mode. Six multipliers make three such solutions and
    their conjugates. In a tongue the growing solution stands for the mode.

    Parameters
    ----------
    pair : the gear pair
    speeds_rpm : (k,) pinion speeds [rpm], increasing
    mesh_orders : multiples of the mesh frequency to list
    orders : largest order k of the predicted lines (omega_i +- omega_j)/k
    rtol : of the monodromy matrices
    supports : "springs"; a pair with shafts must ask for springs, on shafts there is no Campbell diagram

    Returns
    -------
    Dataset over ``speed_rpm``, ``mode``, ``mesh_order`` and ``line``: ``frequency`` and ``decay`` [1/s] of
    the Floquet solution of each mode (speed_rpm, mode); ``natural_frequency`` of the mean system (mode);
    ``mesh_frequency`` (speed_rpm, mesh_order); ``line_speed`` [rpm] and ``line_frequency``, the mesh
    frequency there (line, with the labels in ``label``) inside the range, for modes that deflect the mesh;
    ``spectral_radius`` of the feedback block.

    Raises
    ------
    ParameterError : speeds that are not increasing, or shafts
    NumericalError
        A speed so low that a multiplier is too small for a number.
    """
    pair = on_springs(load_gear_pair(pair), supports, "campbell")
    variation = GearVariation.of(pair)
    speeds = real_numbers("speeds_rpm", speeds_rpm, 0.0, above=True, increasing=True, unit="rpm")
    mesh_orders = whole_number("mesh_orders", mesh_orders, 1, 1000)
    rtol = real_number("rtol", rtol, 1e-13, 1e-3)
    mean = gear_block(pair).modal()
    modes = mean.omega
    # A mode without dynamic transmission error feeds nothing back: no tongue can involve such a mode.
    meshing = np.abs(mean.v) > 1e-9 * np.abs(mean.v).max()
    frequency = np.empty((speeds.size, modes.size))
    decay = np.empty((speeds.size, modes.size))
    radius = np.empty(speeds.size)
    for index, speed in enumerate(speeds):
        block = gear_block(vary(variation, {"speed_rpm": float(speed)}))
        matrix = fast_monodromies(block, tolerance=0.01 * rtol).matrices[0]
        omega = block.modal().omega
        exponents = _exponents_by_mode(matrix, omega, block.period)
        if not np.isfinite(exponents).all():
            raise NumericalError(
                f"At {speed:g} rpm a mode dies out within one mesh cycle: its multiplier is too small for a "
                "number. Raise the lowest speed."
            )
        frequency[index] = exponents.imag / (2.0 * np.pi)
        decay[index] = -exponents.real
        radius[index] = np.exp(exponents.real.max() * block.period)
    teeth = pair.pinion.teeth
    mesh_order = np.arange(1, mesh_orders + 1)
    mesh = speeds[:, None] * teeth / 60.0 * mesh_order
    lines = {
        tongue: speed
        for tongue, speed in predicted_lines(pair, orders).items()
        if speeds[0] <= speed <= speeds[-1] and meshing[tongue.mode_i - 1] and meshing[tongue.mode_j - 1]
    }
    line_speed = np.array(list(lines.values()))
    each = ("speed_rpm", "mode")
    orders_over = ("speed_rpm", "mesh_order")
    return labelled_dataset(
        {
            "frequency": (each, frequency, "Hz", "frequency of the Floquet solution"),
            "decay": (each, decay, "1/s", "decay rate, < 0 growth"),
            "natural_frequency": ("mode", modes / (2.0 * np.pi), "Hz", "that of the mean system"),
            "mesh_frequency": (orders_over, mesh, "Hz", "multiples of the mesh frequency"),
            "line_speed": ("line", line_speed, "rpm", "predicted speed of a tongue"),
            "line_frequency": ("line", line_speed * teeth / 60.0, "Hz", "mesh frequency on the line"),
            "spectral_radius": ("speed_rpm", radius, "1", "spectral radius"),
        },
        {
            "speed_rpm": (speeds, "rpm", "pinion speed"),
            "mode": (np.arange(1, modes.size + 1), "1", "mode of the mean system"),
            "mesh_order": (mesh_order, "1", "multiple of the mesh frequency"),
        },
        provenance(pair) | {"title": f"Campbell diagram of {pair.name}", "supports": "springs"},
    ).assign_coords(tongue_coordinates("line", lines))


def _exponents_by_mode(matrix: FloatArray, omega: FloatArray, period: float) -> ComplexArray:
    """Exponent (m,) [1/s] of the solution for each mode, on the branch near the frequency of the mode."""
    values, vectors = np.linalg.eig(matrix)
    forward = np.stack([mode_shares(x, omega)[0] for x in vectors.T])
    # Each mode gets a solution of its own. In a tongue a growing and a decaying one share the mode equally:
    # the slight preference for the larger modulus takes the growing one.
    modulus = np.abs(values)
    solution, mode = linear_sum_assignment(-forward * (1.0 + 0.01 * modulus / modulus.max())[:, None])
    chosen = values[solution[np.argsort(mode)]].astype(complex)
    # A multiplier that is zero, or so small that it has lost its digits, has no exponent.
    chosen[np.abs(chosen) < np.finfo(np.float64).tiny] = 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        principal = np.log(chosen) / period
    mesh = 2.0 * np.pi / period
    return np.asarray(principal + 1j * mesh * np.round((omega - principal.imag) / mesh))


@dataclass(frozen=True, eq=False, repr=False)
class TongueMargin(DisplayedResult):
    """One tongue of instability at zero mesh damping, and the mesh damping that closes the tongue.

    The bearings have the damping of the pair.

    Attributes
    ----------
    label : modes and order, e.g. "2w3/2": mesh frequency 2 omega_3/2
    lower, upper : boundaries at zero mesh damping [rpm]
    radius : largest multiplier at zero mesh damping
    critical_damping : mesh damping ratio from which on no speed of the tongue is unstable; 1, the largest
        ratio allowed, where the tongue is still open there
    tip_speed : speed at which the tongue closes [rpm]
    damping, left, right : edges of the tongue, left and right [rpm] over the mesh damping ratio, (k,)
    """

    shown: ClassVar = ("label", "lower", "upper", "radius", "critical_damping", "tip_speed")

    label: str
    lower: float
    upper: float
    radius: float
    critical_damping: float
    tip_speed: float
    damping: FloatArray
    left: FloatArray
    right: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class StabilityMargins(DisplayedResult):
    """Distances of the operating point to instability.

    Attributes
    ----------
    pair : the gear pair
    rpm : its pinion speed [rpm]
    damping : its mesh damping ratio
    speed_range : range searched [rpm]
    friction_coefficient : constant coefficient in place of the friction law
    tongues : at zero mesh damping, by speed
    above : the next tongue above the range, at zero mesh damping; None: there is none up to the highest line
    unstable_here : intervals (k, 2) [rpm] that are unstable at the mesh damping of the pair
    damping_at_speed : mesh damping ratio above which the operating speed is stable; None: the operating speed
        is stable at any damping
    """

    shown: ClassVar = (
        "rpm",
        "damping",
        "critical_damping",
        "damping_at_speed",
        "speed_range",
        "friction_coefficient",
        "unstable_here",
        "tongues",
        "above",
    )

    pair: GearPair
    rpm: float
    damping: float
    speed_range: tuple[float, float]
    friction_coefficient: float
    tongues: tuple[TongueMargin, ...]
    above: TongueMargin | None
    unstable_here: FloatArray
    damping_at_speed: float | None

    @property
    def critical_damping(self) -> float:
        """Mesh damping ratio above which the whole range is stable; 0: the range is stable at any damping."""
        return max((t.critical_damping for t in self.tongues), default=0.0)

    @property
    def dataset(self) -> xr.Dataset:
        """Tongues for a file, over ``tongue`` (coordinate label) and ``row``, from zero damping to the tip.

        ``damping_ratio``, ``lower`` and ``upper`` [rpm], NaN beyond the tip; ``critical_damping``,
        ``tip_speed`` [rpm] and ``peak_radius`` of each tongue.
        """
        tongues = self.tongues
        rows = max((t.damping.size for t in tongues), default=0)
        damping = np.full((len(tongues), rows), np.nan)
        lower = np.full((len(tongues), rows), np.nan)
        upper = np.full((len(tongues), rows), np.nan)
        for index, t in enumerate(tongues):
            damping[index, : t.damping.size] = t.damping
            lower[index, : t.damping.size] = t.left
            upper[index, : t.damping.size] = t.right
        critical = np.array([t.critical_damping for t in tongues])
        tip_speed = np.array([t.tip_speed for t in tongues])
        peak_radius = np.array([t.radius for t in tongues])
        edge = ("tongue", "row")
        return labelled_dataset(
            {
                "damping_ratio": (edge, damping, "1", "mesh damping ratio of a point of the edges"),
                "lower": (edge, lower, "rpm", "lower edge of the tongue"),
                "upper": (edge, upper, "rpm", "upper edge of the tongue"),
                "critical_damping": ("tongue", critical, "1", "mesh damping that closes the tongue"),
                "tip_speed": ("tongue", tip_speed, "rpm", "pinion speed where the tongue closes"),
                "peak_radius": ("tongue", peak_radius, "1", "largest multiplier without mesh damping"),
            },
            {},
            {
                **provenance(self.pair),
                "title": "tongues of instability over speed and mesh damping",
                "supports": "springs",
                "friction_coefficient_held": self.friction_coefficient,
            },
        ).assign_coords(label=("tongue", np.array([t.label for t in tongues], dtype=object)))


def stability_margins(
    pair: AnyPair, speed_rpm: tuple[float, float], *, supports: Supports | None = None
) -> StabilityMargins:
    """Find every tongue over speed and its distance to the operating point, in speed and in damping.

    Tongues are of the linear form with like teeth. Friction is constant at its mean over the path of contact,
    because friction moves tongues by far less than their width. A law that depends on speed would need a fit
    at every speed.

    Parameters
    ----------
    pair : the gear pair
    speed_rpm : pinion speeds searched [rpm]
    supports : "springs"; a pair with shafts must ask for springs, on shafts there are no margins

    Raises
    ------
    ParameterError : not two increasing positive speeds, or shafts
    NumericalError : a monodromy matrix cannot be computed; the text says what to try
    """
    pair = on_springs(load_gear_pair(pair), supports, "stability_margins")
    low, high = checked_range("speed_rpm", speed_rpm)
    rpm = operating_rpm(pair)
    damping_ratio = pair.mesh.damping_ratio
    coefficient = mean_coefficient(friction_path_function(pair))
    constant = pair.with_(
        {
            "friction.law": "coulomb",
            "friction.coefficient": coefficient_for(pair, coefficient),
        }
    )
    radius = _radius(constant)
    lines = np.array(list(predicted_lines(constant, _ORDERS).values()))

    def unstable(damping: float, low: float = low, high: float = high) -> list[UnstableInterval]:
        nodes = seeded_nodes(lines, low, high, _SPEED_NODES)
        return unstable_intervals(lambda speeds: radius(speeds, damping), nodes, xtol=1e-8)

    def tongue(interval: UnstableInterval, window: tuple[float, float]) -> TongueMargin:
        return _tongue(radius, constant, interval, window)

    undamped = unstable(0.0)
    tongues = tuple(map(tongue, undamped, _windows(undamped, low, high)))
    top = min((1.0 + _PAST) * float(lines.max()), LARGEST_SPEED)
    beyond = unstable(0.0, high, top) if top > high else []
    # A tongue that is open below begins within the range.
    above = (pair for pair in zip(beyond, _windows(beyond, high, top), strict=True) if not pair[0].open_below)
    dampings = np.concatenate([[0.0], np.geomspace(1e-7, _LARGEST_DAMPING, 150)])
    at_speed = unstable_intervals(lambda z: radius(rpm, z), dampings, xtol=1e-8)
    return StabilityMargins(
        pair=pair,
        rpm=rpm,
        damping=damping_ratio,
        speed_range=(low, high),
        friction_coefficient=coefficient,
        tongues=tongues,
        above=next(itertools.starmap(tongue, above), None),
        unstable_here=np.array([(i.lower, i.upper) for i in unstable(damping_ratio)]).reshape(-1, 2),
        damping_at_speed=max((i.upper for i in at_speed), default=None),
    )


def _radius(pair: GearPair) -> Radius:
    """Spectral radius over speed and mesh damping ratio, from one fit; friction must not depend on speed."""
    block = gear_block(vary(GearVariation.of(pair), {"damping_ratio": _LARGEST_DAMPING}), rtol=0.1 * _RTOL)

    def radius(speeds: npt.ArrayLike, dampings: npt.ArrayLike) -> FloatArray:
        rpm, zeta = np.broadcast_arrays(np.asarray(speeds, dtype=float), np.asarray(dampings, dtype=float))
        periods = block.period * operating_rpm(pair) / rpm.ravel()
        result = spectral_radii(block, periods, zeta.ravel() / _LARGEST_DAMPING, tolerance=1e-3 * _RTOL)
        return result.reshape(rpm.shape)

    return radius


def _windows(intervals: list[UnstableInterval], low: float, high: float) -> list[tuple[float, float]]:
    """Speeds around each interval in which damping closes the tongue.

    A window is wider than the interval by a quarter of the width on either side, because damping shifts a
    tongue a little. A window ends at the latest in the middle between two intervals.
    """
    ends = [low, *(0.5 * (a.upper + b.lower) for a, b in itertools.pairwise(intervals)), high]
    windows = []
    for interval, least, most in zip(intervals, ends, ends[1:], strict=False):  # without a tongue, none
        aside = 0.25 * (interval.upper - interval.lower)
        windows.append((max(interval.lower - aside, least), min(interval.upper + aside, most)))
    return windows


def _tongue(
    radius: Radius, pair: GearPair, interval: UnstableInterval, window: tuple[float, float]
) -> TongueMargin:
    """Follow one tongue from zero damping to the damping that closes the tongue."""

    def excess(speeds: FloatArray, damping: float) -> FloatArray:
        return radius(speeds, damping) - _THRESHOLD

    if (excess(np.linspace(*window, 33), _LARGEST_DAMPING) > 1.0).any():
        tip = TongueTip(_LARGEST_DAMPING, interval.peak)
    else:
        tip = tongue_tip(excess, window, (0.0, _LARGEST_DAMPING))
    damping, lower_edge, upper_edge = _edges(radius, interval, window, tip)
    undamped = vary(GearVariation.of(pair), {"damping_ratio": 0.0, "speed_rpm": interval.peak})
    return TongueMargin(
        label=str(label_variation(undamped)),
        lower=interval.lower,
        upper=interval.upper,
        radius=interval.peak_radius,
        critical_damping=tip.damping,
        tip_speed=tip.place,
        damping=damping,
        left=lower_edge,
        right=upper_edge,
    )


def _edges(
    radius: Radius, interval: UnstableInterval, window: tuple[float, float], tip: TongueTip
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Damping ratios from zero to the tip, and the edges of the tongue there [rpm].

    The width of a tongue is proportional to the root of the distance to the tip. Ratios are therefore spaced
    by squares.
    """
    u = np.linspace(1.0, 0.0, _EDGE_ROWS)[1:-1]
    dampings = tip.damping * (1.0 - u**2)
    # Between these samples lies the place that stays unstable longest, or nearly.
    middle = tip.place + (interval.peak - tip.place) * u**2
    speeds = np.broadcast_to(np.linspace(*window, _EDGE_SPEEDS), (u.size, _EDGE_SPEEDS))
    speeds = np.sort(np.concatenate([speeds, middle[:, None]], axis=1), axis=1)
    unstable = radius(speeds, dampings[:, None]) > 1.0 + _THRESHOLD
    rows = np.flatnonzero(unstable.any(axis=1))
    first = unstable[rows].argmax(axis=1)
    end = speeds.shape[1] - 1
    last = end - unstable[rows, ::-1].argmax(axis=1)
    inside = np.stack([speeds[rows, first], speeds[rows, last]])
    outside = np.stack([speeds[rows, np.maximum(first - 1, 0)], speeds[rows, np.minimum(last + 1, end)]])
    for _ in range(_EDGE_ROUNDS):
        half = 0.5 * (inside + outside)
        still = radius(half, dampings[rows]) > 1.0 + _THRESHOLD
        inside = np.where(still, half, inside)
        outside = np.where(still, outside, half)
    return (
        np.concatenate([[0.0], dampings[rows], [tip.damping]]),
        np.concatenate([[interval.lower], inside[0], [tip.place]]),
        np.concatenate([[interval.upper], inside[1], [tip.place]]),
    )
