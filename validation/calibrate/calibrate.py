"""Calibrate a pair with records of a rig: which values of the assumed inputs move the model as the rig moves.

Several forms of the model, several starts and a discrepancy of the model are the method itself: with one
form, one start or an exact model a posterior is narrow and wrong.

Sources: Kennedy and O'Hagan, J. R. Statist. Soc. B 63 (2001) 425, section 4; docs/how_to/calibrate.md.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import cholesky
from scipy.stats import chi2

from lumped.arguments import whole_number
from lumped.display.progress import reported_to, shows_progress
from lumped.errors import LawRangeWarning, NumericalError, SpurcheckError, refuse
from lumped.model.periodic_system import Supports, with_supports
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, IntArray, ProgressRequest
from validation.calibrate.data import Data
from validation.calibrate.discrepancy import (
    LEVELS,
    discrepancy_covariance,
    noise_covariance,
    prior_of_levels,
    shown_results,
)
from validation.calibrate.fit import STARTS, Fit, Minimum, starts
from validation.calibrate.forms import Form, forms_of, machine, numeric_inputs, pair_of
from validation.calibrate.machines import Machines
from validation.calibrate.measured import measured_records
from validation.calibrate.mixture import Component, by_levels, component, draws, mixture, pareto_shape
from validation.calibrate.posterior import RELIABLE, Posterior
from validation.prediction.motion import predicted
from validation.prediction.uncertain_input import Input

#: Level of the discrepancy in the search for minima.
_SEARCH = 0.05
#: A form of the mesh has further starts where its least chi^2 is at most this above that of the best form.
_APART = 20.0
#: A friction law has a fit of its own where its motions differ by more than this many standard deviations.
_OTHER_LAW = 6.0
#: Components of this probability have a minimum at their own level of the discrepancy.
_PROBABLE = 0.05
#: Further starts at a small level, drawn from the posterior at the level of the search.
_DRAWN = 4
_SEED_OF_STARTS = 11
#: Probability below which no machine of the pair explains the records, even at the largest discrepancy.
_IMPOSSIBLE = 1e-4
#: Share of the motion, as a sum of squares over all orders, that the best machine explains at least.
_EXPLAINED = 0.75
#: Share of the machines that must have a motion.
_LEAST = 0.5


@shows_progress("calibration")
def calibrate(
    pair: AnyPair,
    records: Any,
    discrepancy: bool = True,
    *,
    machines: int = 64,
    seed: int = 1,
    supports: Supports | None = None,
    progress: ProgressRequest = None,
) -> Posterior:
    """Return what records of a rig say about the assumed inputs of a pair.

    The uncertain inputs are those of ``uncertainty``. The result has the possible machines that move as in
    the records: ``Posterior.pair`` is the pair with the best fit and these machines, and ``report``,
    ``uncertainty`` and ``compare`` take their ranges from them.

    Parameters
    ----------
    pair : the gear pair; speed and torque of each record replace those of the pair
    records : one record or a sequence of records: paths of descriptions (TOML) or of data files, mappings,
        data frames, ``Curves``, as ``check`` takes them, over time or mesh cycles, or values over speed
    discrepancy : whether the model may be off in each order of each channel, by a share with a half-normal
        prior of 5 %. Without it the model counts as exact, and the ranges are too narrow
    machines : number of possible machines, 16 to 1023
    seed : seed of the machines
    supports : "springs" leaves shafts and their inputs out; by default the shafts of a pair that has them
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Raises
    ------
    ParameterError : a record that cannot be used, or of another pair; no uncertain input; a pair that has
        been calibrated already
    NumericalError : fewer than half of the machines have a motion
    """
    tell = reported_to(progress)
    pair = with_supports(load_gear_pair(pair), supports)
    count = whole_number("machines", machines, 16, 1023)
    if pair.posterior:
        action = "Give all records together, with the file that was calibrated first."
        raise refuse("posterior", "a pair that was calibrated already", "a pair without [posterior]", action)
    inputs = numeric_inputs(pair)
    if not inputs:
        action = "State ranges in [uncertainty], or in [assumed] what is assumed."
        raise refuse("uncertainty", "none", "at least one uncertain input", action)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)
        data = measured_records(pair, _listed(records))
    forms = forms_of(pair)
    steps = _Steps(tell, inputs=len(inputs), forms=len({one.mesh for one in forms}), machines=count)
    noise = noise_covariance(data)
    of_model = discrepancy_covariance(data)
    factors = {level: cholesky(noise + level**2 * of_model, lower=True) for level in LEVELS}
    levels = dict(zip(LEVELS, prior_of_levels(), strict=True)) if discrepancy else {0.0: 1.0}
    search = factors[_SEARCH if discrepancy else 0.0]
    minima = [
        (form, one)
        for form, found in _minima(pair, forms, inputs, data, search, steps).items()
        for one in found
    ]
    values = np.concatenate([one.values for one in data])
    _refuse_another_pair(data, minima, factors[LEVELS[-1]], values)
    first = [
        component(form, one, level, form.prior * prior, factors[level], values)
        for form, one in minima
        for level, prior in levels.items()
    ]
    first = by_levels(first, levels, values.size)
    refined = _refined(first, pair, forms, inputs, data, factors, levels, steps)
    components = mixture(by_levels(refined, levels, values.size))
    left = _machines(pair, inputs, data, components, factors, count, seed, steps)
    return Posterior(pair, inputs, data, components, left, discrepancy)


def _listed(records: Any) -> list[Any]:
    """The records as a list. One record may stand alone."""
    single = isinstance(records, (str, Path)) or not isinstance(records, Sequence)
    listed = [records] if single else list(records)
    if not listed:
        raise refuse("records", "none", "at least one record", "Name the description of a record.")
    return listed


class _Steps:
    """Progress: predictions made, of about as many as a calibration takes."""

    def __init__(self, tell: Any, *, inputs: int, forms: int, machines: int) -> None:
        self._tell = tell
        self._done = 0
        self._all = (forms + STARTS) * (2 * inputs + 10) + machines

    def __call__(self) -> None:
        self._done += 1
        if self._tell is not None:
            self._tell(min(self._done / self._all, 0.99))


class _Search:
    """Minima of a fit. Of long sweeps the search begins with a few speeds: most of its way costs less."""

    def __init__(self, fit: Fit) -> None:
        self.fit = fit
        self._few = fit.with_few_speeds()
        self._seen: list[Minimum] = []

    def minimum(self, start: FloatArray) -> Minimum | None:
        """Return the minimum that a start leads to; None: no motion, or with few speeds one seen before."""
        if self._few is None:
            return self.fit.minimum(start)
        one = self._few.minimum(start)
        if one is None or not self._few.different(self._seen, one):
            return None
        self._seen.append(one)
        return self.fit.minimum(one.z)


def _minima(
    pair: GearPair,
    forms: Sequence[Form],
    inputs: Sequence[Input],
    data: Sequence[Data],
    factor: FloatArray,
    steps: _Steps,
) -> dict[Form, list[Minimum]]:
    """Minima of each form. Every form of the mesh has one start, the nearly best ones have all starts."""
    by_mesh: dict[tuple[tuple[str, str], ...], list[Form]] = {}
    for form in forms:
        by_mesh.setdefault(form.mesh, []).append(form)
    points = starts(len(inputs))
    fits = {mesh: Fit(pair_of(pair, one[0]), inputs, data, factor, steps) for mesh, one in by_mesh.items()}
    searches = {mesh: _Search(fit) for mesh, fit in fits.items()}
    found = {mesh: _added([], fit, searches[mesh].minimum(points[0])) for mesh, fit in fits.items()}
    least = min((one.chi_squared for minima in found.values() for one in minima), default=np.inf)
    for mesh, fit in fits.items():
        if not found[mesh] or min(one.chi_squared for one in found[mesh]) <= least + _APART:
            for point in points[1:]:
                _added(found[mesh], fit, searches[mesh].minimum(point))
    result: dict[Form, list[Minimum]] = {}
    for mesh, same_mesh in by_mesh.items():
        result[same_mesh[0]] = found[mesh]
        near = [one for one in found[mesh] if one.chi_squared <= least + _APART][:STARTS]
        for form in same_mesh[1:]:
            fit = Fit(pair_of(pair, form), inputs, data, factor, steps)
            result[form] = [one for other in near if (one := _of_law(fit, other)) is not None]
    if not any(result.values()):
        raise NumericalError("No form of the model has a motion at the speeds and torques of the records.")
    return result


def _refined(
    components: Sequence[Component],
    pair: GearPair,
    forms: Sequence[Form],
    inputs: Sequence[Input],
    data: Sequence[Data],
    factors: dict[float, FloatArray],
    levels: dict[float, float],
    steps: _Steps,
) -> list[Component]:
    """The components, where probable ones of smaller levels have a minimum of their own.

    The search was made at the level ``_SEARCH``. At a smaller level the data are known more closely, and the
    slopes of that minimum are those of a point too far away.
    """
    probable = [
        one
        for one in mixture(components)
        if one.level < _SEARCH and one.weight > _PROBABLE and len(levels) > 1
    ]
    places = {(one.form.mesh, one.level) for one in probable}
    # The slopes of the old minima are not those of these levels: new minima take their place.
    result = [old for old in components if (old.form.mesh, old.level) not in places]
    refined: dict[tuple[tuple[tuple[str, str], ...], float], list[Minimum]] = {}
    searches: dict[tuple[tuple[tuple[str, str], ...], float], _Search] = {}
    for one, start in _starts_at_levels(probable, components):
        mesh, level = one.form.mesh, one.level
        if (mesh, level) not in searches:
            fit = Fit(pair_of(pair, one.form), inputs, data, factors[level], steps)
            searches[mesh, level] = _Search(fit)
        fit = searches[mesh, level].fit
        minimum = searches[mesh, level].minimum(start)
        same = refined.setdefault((mesh, level), [])
        if minimum is None or not fit.different(same, minimum):
            continue
        same.append(minimum)
        for form in forms:
            if form.mesh != mesh:
                continue
            other = Fit(pair_of(pair, form), inputs, data, factors[level], steps)
            of_form = minimum if form == one.form else _of_law(other, minimum)
            if of_form is not None:
                values = fit.data
                prior = form.prior * levels[level]
                result.append(component(form, of_form, level, prior, factors[level], values))
    return result


def _starts_at_levels(
    probable: Sequence[Component], components: Sequence[Component]
) -> list[tuple[Component, FloatArray]]:
    """Starts of the search at small levels: probable components, and draws of the wide one of the same mesh.

    A valley that is one minimum at the level of the search may have several minima at a smaller level.
    """
    found = [(one, one.z) for one in probable]
    seen = set()
    for one in probable:
        if (place := (one.form.mesh, one.level)) in seen:
            continue
        seen.add(place)
        wide = [other for other in components if other.form == one.form and other.level == _SEARCH]
        best = max(wide, key=lambda other: other.weight)
        points = draws([replace(best, weight=1.0)], _DRAWN, _SEED_OF_STARTS)[1]
        found += [(one, point) for point in points]
    return found


def _added(found: list[Minimum], fit: Fit, one: Minimum | None) -> list[Minimum]:
    """The minima with another one, unless it is there already; of two equal ones the deeper one stays."""
    if one is None:
        return found
    for number, other in enumerate(found):
        if not fit.different([other], one):
            found[number] = min(one, other, key=lambda minimum: minimum.chi_squared)
            return found
    found.append(one)
    return found


def _of_law(fit: Fit, other: Minimum) -> Minimum | None:
    """Minimum with another friction law, from the minimum of the first law. None: no motion.

    Where the records hardly show the law, the slopes of the first law hold.
    """
    motions = fit.motions(other.z)
    if motions is None:
        return None
    apart = np.linalg.solve(fit.factor, motions.values - other.motions.values)
    if np.linalg.norm(apart) > _OTHER_LAW:  # friction forces are among the channels
        return fit.minimum(other.z)
    return replace(other, motions=motions, chi_squared=fit.chi_squared(other.z, motions))


def _refuse_another_pair(
    data: Sequence[Data],
    minima: Sequence[tuple[Form, Minimum]],
    factor: FloatArray,
    values: FloatArray,
) -> None:
    """Refuse records that no machine of the pair explains, even with the largest discrepancy of the model."""
    least = min(component(form, one, LEVELS[-1], 1.0, factor, values).chi_squared for form, one in minima)
    scales = np.concatenate([one.scales for one in data])
    motion = values / scales
    rests = [motion - one.motions.values / scales for _, one in minima]
    explained = max(max(1.0 - float(rest @ rest) / float(motion @ motion) for rest in rests), 0.0)
    if chi2.sf(least, values.size) >= _IMPOSSIBLE and explained >= _EXPLAINED:
        return
    names = ", ".join(dict.fromkeys(one.name for one in data))
    raise refuse(
        "records",
        f"{names}: the best machine explains {100.0 * explained:.0f} % of the motion",
        f"a motion of this pair, within {100.0 * LEVELS[-1]:.0f} %, for inputs in their ranges",
        "Check pair, units and channels: spurcheck check PAIR RECORD names what would explain the record.",
    )


def _machines(
    pair: GearPair,
    inputs: Sequence[Input],
    data: Sequence[Data],
    components: Sequence[Component],
    factors: dict[float, FloatArray],
    count: int,
    seed: int,
    steps: _Steps,
) -> Machines:
    """Possible machines: draws of the mixture, weighted by their own predictions, and the best fit first."""
    places, z = draws(components, count, seed)
    z = np.vstack([components[0].minimum.z, z])
    places = [0, *places]
    pairs = {one.form: pair_of(pair, one.form) for one in components}
    numbers, log_weights, kept = [], [], []
    for j, place in enumerate(places):
        one = components[place]
        fit = Fit(pairs[one.form], inputs, data, factors[one.level])
        steps()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", LawRangeWarning)
                prediction = predicted(machine(fit.pair, inputs, z[j]))
        except SpurcheckError:
            if j == 0:
                raise
            continue
        motions = fit.motions(z[j])
        if motions is None:
            continue
        away = z[j] - one.z
        linear = one.chi_squared + float(away @ np.linalg.solve(one.covariance, away))
        log_weights.append(0.5 * (linear - fit.chi_squared(z[j], motions)))
        numbers.append(prediction.numbers)
        kept.append(j)
    if len(kept) < 1 + _LEAST * count:
        raise NumericalError(f"Only {len(kept) - 1} of {count} machines have a motion: narrow the ranges.")
    shape = pareto_shape(np.array(log_weights[1:]))
    chosen = _resampled(np.array(log_weights[1:]), seed) if shape < RELIABLE else np.arange(len(kept) - 1)
    order = [0, *(1 + int(j) for j in chosen)]
    return Machines(
        z=z[kept][order],
        components=[components[places[kept[j]]] for j in order],
        numbers=[numbers[j] for j in order],
        shown=shown_results(data),
        shape=shape,
        seed=seed,
    )


def _resampled(log_weights: FloatArray, seed: int) -> IntArray:
    """Draws by their weights, as many as there are; the weights are cut at the root of their number.

    Source: Ionides, J. Comput. Graph. Statist. 17 (2008) 295.
    """
    weights = np.exp(log_weights - log_weights.max())
    weights = np.minimum(weights, weights.mean() * np.sqrt(weights.size))
    ends = np.cumsum(weights) / weights.sum()
    offset = np.random.default_rng(seed).random()
    places = np.searchsorted(ends, (np.arange(weights.size) + offset) / weights.size)
    return np.asarray(np.minimum(places, weights.size - 1), dtype=np.int64)
