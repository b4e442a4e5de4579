"""Stability charts of gear pairs: the compiled route for dense charts, the general engine as its check."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from floquet.chart import Axes, Progress, chart_dataset, checked_axes, scan
from floquet.fast import FastMonodromy, fast_monodromies, fast_multipliers
from floquet.gear_axes import GearVariation, gear_axis, vary
from floquet.gear_block import gear_block
from floquet.gear_friction import depends_on_speed, friction_factors
from floquet.gear_multipliers import gear_pair_multipliers, oloa_exponents
from floquet.interpolation import interpolated_multipliers
from floquet.propagators import Propagator
from floquet.spectrum import Spectrum
from floquet.system import ComplexArray, FloatArray
from lumped.errors import refuse
from lumped.parameters import GearPair
from lumped.periodic_system import periodic_system

if TYPE_CHECKING:
    import xarray as xr

_INNER = ("speed_rpm", "damping_ratio", "friction_coefficient")
_REFERENCE_DAMPING = 1.0
_ROWS = 65_536


def stability_chart(
    pair: GearPair,
    axes: Axes,
    *,
    friction_law: str | None = None,
    rtol: float = 1e-10,
    method: str | Propagator = "taylor",
    n_jobs: int | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Stability chart of a gear pair.

    Parameters
    ----------
    pair : the gear pair
    axes : name -> values, names out of `GEAR_AXES`: speed_rpm, damping_ratio (mesh), friction_coefficient,
        torque, stiffness_variation, bearing_stiffness, in their stated units
    friction_law : law to use instead of the pair's: "coulomb" for a constant |mu| that changes sign at the
        pitch point, the others for mu that varies along the path. With an axis friction_coefficient the law
        is scaled to that mean of |mu|.
    rtol : wanted accuracy of the monodromy matrices, relative to their scale; 1e-13 to 1e-3
    method : "taylor", the compiled kernel; "chebyshev", the same at some thousand nodes with a checked
        interpolation in speed and in damping or friction between them, for charts of many more points than
        that; or a method of `monodromy` for an independent check
    n_jobs : threads (Taylor) or processes (others); default all cores for Taylor, 1 for the others
    progress : called with (points done, points in all)

    Returns
    -------
    xarray.Dataset over the axes: spectral_radius, error, verdict, multipliers, multiplier_errors (10 each:
    the feedback block and the off-line-of-action block; the rigid rotation is no part of them)

    Raises
    ------
    ParameterError
        Unknown axis, or values outside the range of an axis.
    NumericalError
        A point fails; the message names it.
    """
    grid = checked_axes(axes)
    for name, values in grid.items():
        gear_axis(name).check(name, values)
    if friction_law is not None:
        pair = pair.with_({"friction.law": friction_law})
    if method in ("taylor", "chebyshev"):
        if not 1e-13 <= rtol <= 1e-3:
            raise refuse("rtol", rtol, "1e-13 to 1e-3", "Use 1e-8 for charts, 1e-10 for verdicts.")
        if method == "chebyshev" and "speed_rpm" not in grid:
            raise refuse(
                "method", method, '"taylor" for axes without speed_rpm', "Interpolation is over speed."
            )
        dataset = _taylor_chart(pair, grid, rtol, n_jobs, progress, method == "chebyshev")
    else:
        evaluate = partial(_evaluate, pair, rtol, method)
        dataset = scan(evaluate, grid, n_jobs=n_jobs or 1, progress=progress)
    for name in grid:
        axis = gear_axis(name)
        dataset[name].attrs.update(units=axis.units, long_name=axis.long_name)
    dataset.attrs.update(
        title=f"stability chart of {pair.name}",
        friction_law=pair.friction.law,
        method=method if isinstance(method, str) else method.name,
        rtol=rtol,
    )
    return dataset


def _evaluate(pair: GearPair, rtol: float, method: str | Propagator, point: dict[str, float]) -> Spectrum:
    return gear_pair_multipliers(vary(pair, point), rtol, method=method)


def _taylor_chart(
    pair: GearPair,
    grid: Mapping[str, FloatArray],
    rtol: float,
    threads: int | None,
    progress: Progress | None,
    interpolate: bool,
) -> xr.Dataset:
    """Fit the block once per point of the slow axes, then run the kernel over the fast ones.

    Damping only scales wd, the mean friction coefficient only scales what friction adds to w, and speed only
    changes the period, and with many friction laws scales friction too.
    """
    names, shape = list(grid), tuple(values.size for values in grid.values())
    inner = [name for name in names if name in _INNER and not _is_slow(name, grid)]
    if interpolate and len(inner) == 3:
        inner.remove("friction_coefficient")
    outer = [name for name in names if name not in inner]
    mesh = np.meshgrid(*(grid[name] for name in inner), indexing="ij")
    flat = {name: m.ravel() for name, m in zip(inner, mesh, strict=True)}
    inner_shape = tuple(grid[name].size for name in inner)
    values, errors = np.empty((*shape, 10), dtype=complex), np.empty((*shape, 10))
    done = 0

    def report(count: int) -> None:
        nonlocal done
        done += count
        if progress is not None:
            progress(done, math.prod(shape))

    for index in product(*(range(grid[name].size) for name in outer)):
        where = dict(zip(outer, index, strict=True))
        point = {name: float(grid[name][i]) for name, i in where.items()}
        found = _inner_points(pair, point, flat, math.prod(inner_shape), rtol, threads, report, interpolate)
        key = tuple(where.get(name, slice(None)) for name in names)
        for target, source in zip((values, errors), found, strict=True):
            target[key] = source.reshape(*inner_shape, 10)
        del found
    values, errors = values.reshape(-1, 10), errors.reshape(-1, 10)
    radius, radius_error = _sorted_in_place(values, errors)
    return chart_dataset(grid, values, errors, radius, radius_error)


def _sorted_in_place(values: ComplexArray, errors: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Put the largest multiplier of each row first; return the radii and their bounds.

    By parts: a chart of a million points should not need its memory several times over.
    """
    radius, radius_error = np.empty(values.shape[0]), np.empty(values.shape[0])
    for first in range(0, radius.size, _ROWS):
        part = slice(first, first + _ROWS)
        ranking = np.argsort(-np.abs(values[part]), axis=1, kind="stable")
        values[part] = np.take_along_axis(values[part], ranking, 1)
        errors[part] = np.take_along_axis(errors[part], ranking, 1)
        modulus = np.abs(values[part])
        radius[part] = modulus[:, 0]
        high, low = (modulus + errors[part]).max(axis=1), (modulus - errors[part]).max(axis=1)
        radius_error[part] = np.maximum(high - radius[part], radius[part] - low)
    return radius, radius_error


def _is_slow(name: str, grid: Mapping[str, FloatArray]) -> bool:
    """A friction axis that is zero throughout has no reference to scale."""
    return name == "friction_coefficient" and float(grid[name].max()) == 0.0


def _inner_points(
    pair: GearPair,
    point: Mapping[str, float],
    flat: Mapping[str, FloatArray],
    count: int,
    rtol: float,
    threads: int | None,
    report: Callable[[int], None],
    interpolate: bool,
) -> tuple[ComplexArray, FloatArray]:
    """Multipliers (count, 10) and their bounds over the fast axes at one point of the others."""
    reference = {name: float(flat[name].max()) for name in flat if name != "speed_rpm"}
    if "damping_ratio" in reference:
        reference["damping_ratio"] = _REFERENCE_DAMPING
    fixed = {**point, **reference}
    damping = flat["damping_ratio"] / _REFERENCE_DAMPING if "damping_ratio" in flat else np.ones(count)
    friction = np.ones(count)
    if "friction_coefficient" in flat:
        friction = flat["friction_coefficient"] / reference["friction_coefficient"]
    variation = vary(pair, fixed)
    own = np.array([variation.pair.operating.pinion_speed * 30.0 / np.pi])
    speeds = flat.get("speed_rpm", np.broadcast_to(own, (count,)))
    unique, which = np.unique(speeds, return_inverse=True)
    factors = friction_factors(variation, unique)
    if interpolate:
        if factors is None:
            raise refuse(
                "method",
                "chebyshev",
                f'"taylor" for law {variation.pair.friction.law}, whose switches move with speed',
                "Use the direct method, or a law that speed only scales.",
            )
        found = _interpolated_points(variation, own[0] / unique, which, damping, friction, rtol, threads)
        report(count)
        return found
    if factors is not None:
        found = _block_points(variation, own[0] / speeds, damping, friction * factors[which], rtol, threads)
        report(count)
        return found
    values, errors = np.empty((count, 10), dtype=complex), np.empty((count, 10))
    for i, rpm in enumerate(unique):
        part = np.flatnonzero(which == i)
        there = vary(pair, {**fixed, "speed_rpm": float(rpm)})
        values[part], errors[part] = _block_points(
            there, np.ones(part.size), damping[part], friction[part], rtol, threads
        )
        report(part.size)
    return values, errors


def _block_points(
    variation: GearVariation,
    period_factors: FloatArray,
    damping: FloatArray,
    friction: FloatArray,
    rtol: float,
    threads: int | None,
) -> tuple[ComplexArray, FloatArray]:
    """Multipliers (k, 10) and bounds of one pair with these factors on its period, damping and friction."""
    apart = bool((friction != 1.0).any())
    block = gear_block(variation, rtol=min(1e-9, 0.1 * rtol), friction_apart=apart)
    periods = block.period * period_factors
    result = fast_multipliers(block, periods, damping, friction, tolerance=2e-3 * rtol, threads=threads)
    exponents = oloa_exponents(periodic_system(variation.pair, "relative"))
    angle = exponents[None, :] * periods[:, None]
    oloa = np.exp(angle)
    oloa_errors = 4e-16 * (1.0 + np.abs(angle)) * np.abs(oloa)  # rounding of the exponent
    return (
        np.concatenate([result.multipliers, oloa], axis=1),
        np.concatenate([result.errors, oloa_errors], axis=1),
    )


def _interpolated_points(
    variation: GearVariation,
    period_factors: FloatArray,
    which: npt.NDArray[np.intp],
    damping: FloatArray,
    friction: FloatArray,
    rtol: float,
    threads: int | None,
) -> tuple[ComplexArray, FloatArray]:
    """`_block_points` by interpolation over periods and over damping or friction, whichever varies.

    ``which`` says for each point which of the (unique) period factors it has.
    """
    by_friction = bool(np.ptp(friction) > 0.0)
    other, column = np.unique(friction if by_friction else damping, return_inverse=True)
    fixed = float(damping[0] if by_friction else friction[0])
    own_rpm = variation.pair.operating.pinion_speed * 30.0 / np.pi
    apart = by_friction or fixed != 1.0 or depends_on_speed(variation.pair)
    block = gear_block(variation, rtol=min(1e-11, 1e-3 * rtol), friction_apart=apart)
    form = block.modal()

    def flow(periods: FloatArray, parameters: FloatArray) -> FastMonodromy:
        unique, index = np.unique(periods, return_inverse=True)
        scale = friction_factors(variation, own_rpm * block.period / unique)
        assert scale is not None  # the caller found it at the speeds of the chart
        here = scale[index] * (parameters if by_friction else fixed)
        zeta = np.full(periods.size, fixed) if by_friction else parameters
        return fast_monodromies(
            block, periods, zeta, here, tolerance=max(1e-5 * rtol, 1e-14), threads=threads
        )

    result, _ = interpolated_multipliers(
        flow, block.period * period_factors, other, float(form.omega.max()), 1e-3 * rtol, threads
    )
    exponents = oloa_exponents(periodic_system(variation.pair, "relative"))
    angle = exponents[None, :] * (block.period * period_factors)[:, None]
    oloa = np.exp(angle)
    oloa_errors = 4e-16 * (1.0 + np.abs(angle)) * np.abs(oloa)  # rounding of the exponent
    at = which * other.size + column
    return (
        np.concatenate([result.multipliers[at], oloa[which]], axis=1),
        np.concatenate([result.errors[at], oloa_errors[which]], axis=1),
    )
