"""Stability charts of gear pairs: the compiled route for dense charts, the general engine as its check."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from itertools import product

import numpy as np
import xarray as xr

from floquet.chart import Axes, Progress, chart_dataset, checked_axes, scan
from floquet.fast import fast_multipliers
from floquet.gear_axes import gear_axis, vary
from floquet.gear_block import gear_block
from floquet.gear_multipliers import gear_pair_multipliers, oloa_exponents
from floquet.propagators import Propagator
from floquet.spectrum import Spectrum
from floquet.system import FloatArray
from lumped.errors import refuse
from lumped.parameters import GearPair
from lumped.periodic_system import periodic_system

_INNER = ("speed_rpm", "damping_ratio")
_REFERENCE_DAMPING = 1.0


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
    method : "taylor", the compiled kernel, or a method of `monodromy` for an independent check
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
    if method == "taylor":
        if not 1e-13 <= rtol <= 1e-3:
            raise refuse("rtol", rtol, "1e-13 to 1e-3", "Use 1e-8 for charts, 1e-10 for verdicts.")
        dataset = _taylor_chart(pair, grid, rtol, n_jobs, progress)
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


def depends_on_speed(pair: GearPair) -> bool:
    """Say whether mu(xi) changes with speed: every law but a constant one whose coefficient is given."""
    friction = pair.friction
    nominal = friction.law in ("coulomb", "smoothed_coulomb") and friction.coefficient is not None
    return not (friction.law == "none" or nominal)


def _taylor_chart(
    pair: GearPair,
    grid: Mapping[str, FloatArray],
    rtol: float,
    threads: int | None,
    progress: Progress | None,
) -> xr.Dataset:
    """Fit the block once per point of the slow axes, then run the kernel over speed and damping.

    Speed only changes the period and damping only scales wd, unless the friction law depends on speed.
    """
    shape = tuple(values.size for values in grid.values())
    names = list(grid)
    probe = vary(pair, {name: float(values[0]) for name, values in grid.items()}).pair
    inner = [n for n in _INNER if n in grid and not (n == "speed_rpm" and depends_on_speed(probe))]
    outer = [n for n in names if n not in inner]
    values = np.empty((*shape, 10), dtype=complex)
    errors = np.empty((*shape, 10))
    inner_shape = tuple(grid[n].size for n in inner)
    mesh = np.meshgrid(*(grid[n] for n in inner), indexing="ij")
    flat = {n: m.ravel() for n, m in zip(inner, mesh, strict=True)}
    count = math.prod(inner_shape)
    done = 0
    for index in product(*(range(grid[n].size) for n in outer)):
        point = {n: float(grid[n][i]) for n, i in zip(outer, index, strict=True)}
        block_values, block_errors = _inner_points(pair, point, flat, count, rtol, threads)
        where = dict(zip(outer, index, strict=True))
        key = tuple(where.get(n, slice(None)) for n in names)
        kept = [n for n in names if n in inner]
        order = [inner.index(n) for n in kept]
        for target, source in ((values, block_values), (errors, block_errors)):
            target[key] = source.reshape(*inner_shape, 10).transpose(*order, len(inner))
        done += count
        if progress is not None:
            progress(done, math.prod(shape))
    values, errors = values.reshape(-1, 10), errors.reshape(-1, 10)
    modulus = np.abs(values)
    ranking = np.argsort(-modulus, axis=1, kind="stable")
    values, errors, modulus = (np.take_along_axis(a, ranking, 1) for a in (values, errors, modulus))
    radius = modulus[:, 0]
    high, low = (modulus + errors).max(axis=1), (modulus - errors).max(axis=1)
    return chart_dataset(grid, values, errors, radius, np.maximum(high - radius, radius - low))


def _inner_points(
    pair: GearPair,
    point: Mapping[str, float],
    flat: Mapping[str, FloatArray],
    count: int,
    rtol: float,
    threads: int | None,
) -> tuple[np.ndarray[tuple[int, ...], np.dtype[np.complex128]], FloatArray]:
    """Multipliers (count, 10) and their bounds over speed and damping at one point of the other axes."""
    damping = flat.get("damping_ratio")
    fixed = dict(point) if damping is None else {**point, "damping_ratio": _REFERENCE_DAMPING}
    variation = vary(pair, fixed)
    block = gear_block(variation, rtol=min(1e-9, 0.1 * rtol))
    rpm = variation.pair.operating.pinion_speed * 30.0 / np.pi
    periods = np.broadcast_to(block.period * rpm / flat.get("speed_rpm", np.array(rpm)), (count,))
    factors = np.ones(count) if damping is None else damping / _REFERENCE_DAMPING
    result = fast_multipliers(block, periods, factors, tolerance=0.01 * rtol, threads=threads)
    exponents = oloa_exponents(periodic_system(variation.pair, "relative"))
    angle = exponents[None, :] * periods[:, None]
    oloa = np.exp(angle)
    oloa_errors = 4e-16 * (1.0 + np.abs(angle)) * np.abs(oloa)  # rounding of the exponent
    return (
        np.concatenate([result.multipliers, oloa], axis=1),
        np.concatenate([result.errors, oloa_errors], axis=1),
    )
