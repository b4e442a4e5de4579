"""Multipliers at many nodes of a chart: systems whose A(t) is a formula together, all others one by one.

Sources: docs/theory/floquet.md, "Many systems at once".
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from floquet.engine.coefficients import PeriodicMatrix
from floquet.engine.formula_steps import Formulas, proven_flows
from floquet.engine.many_multipliers import quick_multipliers
from floquet.engine.monodromy import DEAD, checked_effort, monodromy
from floquet.engine.multipliers import Spectrum, multipliers_with_bounds, radii_with_bounds, verdicts
from floquet.engine.neutral import definite_signatures, on_unit_circle
from floquet.engine.sampled_nodes import PeriodicSystems, estimated_multipliers
from floquet.engine.stacked import alike
from floquet.engine.system import PeriodicSystem
from lumped.arguments import of_type
from lumped.errors import NumericalError, refuse
from lumped.typing import BoolArray, ComplexArray, FloatArray, IntArray

Point = Mapping[str, float]
"""Parameters of a node by name."""
Family = Callable[[dict[str, float]], Spectrum | PeriodicSystem]
"""Parameters -> the periodic system there, or its multipliers."""
BatchedFamily = Callable[[dict[str, FloatArray]], PeriodicSystems]
"""Parameters (N,) -> the periodic systems there."""
TOGETHER = 256
"""Nodes that are evaluated together: enough that the work for each call counts little."""
TOGETHER_IN_ONE_CALL = 512
"""The same of a batched family."""
_MAX_SUBSTEPS = 200_000  # of a period, as of `monodromy`


@dataclass(frozen=True, eq=False)
class NodeSpectra:
    """Multipliers of some of the points.

    Attributes
    ----------
    points : (k,) their places in the list of points
    multipliers, errors : (k, n) with bounds, in no order
    proven : whether the errors are proven bounds
    neutral : (k,) whether all multipliers are proven to be on the unit circle and all motions bounded
    """

    points: IntArray
    multipliers: ComplexArray
    errors: FloatArray
    proven: bool
    neutral: BoolArray


def node_spectra(evaluate: Family, points: Sequence[Point], rtol: float) -> Iterator[NodeSpectra]:
    """Yield the multipliers of all points in groups.

    Raises
    ------
    NumericalError
        A point fails; the message names it.
    """
    systems = []
    places = []
    for k, point in enumerate(points):
        result = _at_point(evaluate, point)
        if isinstance(result, PeriodicSystem) and isinstance(result.A, PeriodicMatrix):
            systems.append((result, result.A))
            places.append(k)
        else:
            yield _alone(k, point, result, rtol)
    for group in alike([A for _, A in systems]):
        members = [systems[k] for k in group]
        node_numbers = np.array(places)[group]
        try:
            yield _together(node_numbers, members, rtol)
        except NumericalError:  # which of the systems it is, is in the message of the system alone
            for k, (system, _) in zip(node_numbers, members, strict=True):
                yield _alone(int(k), points[k], system, rtol)


def sampled_spectra(evaluate: BatchedFamily, points: Sequence[Point], rtol: float) -> NodeSpectra:
    """Multipliers of all points by one call of a family of `PeriodicSystems`, with estimated errors."""
    columns = {name: np.array([point[name] for point in points]) for name in points[0]}
    first, last = place_of(points[0]), place_of(points[-1])
    try:
        systems = of_type(
            "evaluate", evaluate(columns), PeriodicSystems, "a function that returns PeriodicSystems"
        )
        result = estimated_multipliers(systems, len(points), rtol)
    except NumericalError as failure:
        raise NumericalError(f"between {first} and {last}: {failure}") from failure
    nobody = np.zeros(len(points), dtype=bool)
    return NodeSpectra(np.arange(len(points)), result.multipliers, result.errors, False, nobody)


def _at_point(evaluate: Family, point: Point) -> Spectrum | PeriodicSystem:
    try:
        result = evaluate(dict(point))
    except NumericalError as failure:
        raise NumericalError(f"at {place_of(point)}: {failure}") from failure
    if isinstance(result, PeriodicSystem):
        return result
    return of_type("evaluate", result, Spectrum, "a function that returns a PeriodicSystem or a Spectrum")


def _alone(number: int, point: Point, result: Spectrum | PeriodicSystem, rtol: float) -> NodeSpectra:
    """Multipliers of one point."""
    try:
        spectrum = monodromy(result, rtol) if isinstance(result, PeriodicSystem) else result
    except NumericalError as failure:
        raise NumericalError(f"at {place_of(point)}: {failure}") from failure
    return NodeSpectra(
        np.array([number]),
        spectrum.multipliers[None],
        spectrum.multiplier_errors[None],
        spectrum.certificate == "proven",
        np.array([spectrum.neutral]),
    )


def _together(numbers: IntArray, systems: Sequence[Formulas], rtol: float) -> NodeSpectra:
    """Multipliers of systems with as many states and terms, all with proven bounds.

    The quick bound of the multipliers serves where it decides the verdict, else the careful bound.
    """
    checked_effort(rtol, _MAX_SUBSTEPS)
    flows = proven_flows(systems, rtol, _MAX_SUBSTEPS)
    sizes = np.maximum(np.linalg.norm(flows.matrices, ord=2, axis=(1, 2)), DEAD)
    if not (flows.bounds <= rtol * sizes).all():
        raise NumericalError("the tolerance cannot be proven")  # `monodromy` of the system alone says more
    values, errors, safe = quick_multipliers(flows.matrices, flows.bounds)
    symplectic = np.array([system.symplectic for system, _ in systems])

    def neutral_of(nodes: IntArray) -> BoolArray:
        circle = on_unit_circle(flows.matrices[nodes], flows.bounds[nodes], values[nodes], errors[nodes])
        return np.asarray(circle & symplectic[nodes])

    neutral = np.zeros(safe.size, dtype=bool)
    quick = np.flatnonzero(safe)
    neutral[quick] = neutral_of(quick)
    careful = np.flatnonzero(~safe | (verdicts(*radii_with_bounds(values, errors), neutral) == 0))
    for node in careful:
        bounds = multipliers_with_bounds(flows.matrices[node], float(flows.bounds[node]))
        values[node], errors[node] = bounds
    neutral[careful] = neutral_of(careful)
    for node in careful[~neutral[careful]]:
        form = systems[node][0].kept_form
        if form is not None:
            scaled = form.scaled(flows.scalings[node])
            neutral[node] = definite_signatures(flows.matrices[node], float(flows.bounds[node]), scaled)
    return NodeSpectra(numbers, values, errors, True, neutral)


def refuse_other_sizes(first_size: int, size: int, point: Point) -> None:
    """Refuse a point with another number of multipliers than the first point."""
    if size != first_size:
        advice = "Keep the number of coordinates over the axes."
        value = f"{size} multipliers at {place_of(point)}"
        raise refuse("evaluate", value, f"{first_size} as at the first point", advice)


def place_of(point: Point) -> str:
    """A point in words."""
    return ", ".join(f"{name} = {value:g}" for name, value in point.items())
