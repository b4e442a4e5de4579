"""Multipliers of a gear pair: what the mesh couples as a rank-one system, the rest in closed form.

Of teeth that differ, the maps of all cycles are multiplied. Sources: docs/theory/floquet.md, "Structure";
docs/theory/teeth.md, "Stability".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, get_args

import numpy as np
from scipy.linalg import block_diag, eigh

from floquet.engine.formula_steps import proven_product
from floquet.engine.monodromy import integral_of_trace, monodromy
from floquet.engine.multipliers import Certificate, Spectrum, multipliers_with_bounds, radii_with_bounds
from floquet.engine.neutral import separate_from_mirror_images
from floquet.engine.propagators.one_step import Propagator
from floquet.engine.system import PeriodicSystem
from floquet.gear.axes import GearVariation
from floquet.gear.gains import Intervals, MeshGains, OwnGains, own_tables
from floquet.rank_one.batch import FastMonodromy, fast_monodromies, fast_multipliers
from floquet.rank_one.piecewise import fit_pieces
from floquet.rank_one.system import Gains, RankOneSystem
from lumped.arguments import one_of, real_number
from lumped.compiler import in_threads
from lumped.display.result import DisplayedResult
from lumped.mesh.tables import RIPPLES
from lumped.model.periodic_system import AnySupports, LTVSystem, Supports
from lumped.model.supports import Form
from lumped.model.tooth_laws import ToothLaws
from lumped.path_of_contact.friction import friction_misfit
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.meeting_teeth import period_of
from lumped.typing import BoolArray, ComplexArray, FloatArray

MODES = 12
"""Modes of a pair on shafts that are coupled at most; the others move each by itself."""
_EQUAL = 1e-6  # natural frequencies that differ by no more than this part are one
_U = 0.5 * float(np.finfo(np.float64).eps)
_LARGEST = 700.0  # growth beyond the largest number, as a logarithm
_BLOCK = 32  # mesh cycles that are one period of the kernel, at most
_SMALLEST = -250.0  # logarithm of the smallest product of these cycles


@dataclass(frozen=True, eq=False)
class Feedback:
    """The coordinates that the mesh couples: three on springs, one on rigid bearings, at most `MODES` modes.

    Attributes
    ----------
    system : x' = A(t) x in these coordinates; modes of a pair on shafts have unit modal mass
    metric : (m,) weights of the norm of errors; they make the frictionless mesh symmetric
    separate : decay rates [1/s] and squares of the natural frequencies (k,) of motions that the mesh does not
        couple: on springs off the line of action, on shafts the modes of least importance, on rigid bearings
        none
    misfit : (pieces,) bound on the error of the polynomials of mu
    """

    system: LTVSystem
    metric: FloatArray
    separate: tuple[FloatArray, FloatArray]
    misfit: FloatArray


def feedback_system(variation: GearVariation) -> Feedback:
    """Return the coordinates of a gear pair that the mesh couples."""
    system = LTVSystem.of(variation.pair, "mesh", cycle=variation.cycle(), supports=variation.supports)
    interval = system.cycle.elements.friction.interval
    misfit = variation.friction_scale * friction_misfit(variation.pair, interval)
    if variation.supports == "shafts":
        return _leading_modes(system, misfit)
    metric = 1.0 / np.abs(system.per_load[0])
    if variation.supports == "rigid":
        return Feedback(system, metric, (np.zeros(0), np.zeros(0)), misfit)
    s = system.structure
    separate = s.damping[4:] / (2.0 * s.mass[4:]), s.stiffness[4:] / s.mass[4:]
    return Feedback(system, metric, separate, misfit)


def stays_symmetric(feedback: Feedback, supports: AnySupports, friction: BoolArray) -> BoolArray:
    """Whether the parameters state that without mesh damping M z'' + K(t) z = 0 with symmetric K(t), (k,).

    With one coordinate every K(t) is symmetric, also that of friction. Else this is so without friction, on
    springs without damping: K + k(t) v v^T. There the force of a tip corner, which is not normal to the
    flanks, pushes the gears apart off the line of action only. On shafts modes are rounded: False.

    Parameters
    ----------
    friction : (k,) whether friction acts
    """
    if supports == "rigid":
        return np.ones(np.shape(friction), dtype=bool)
    system = feedback.system
    m = system.deflection.size
    damped = bool(system.constant[m:, m:].any())
    return np.asarray(~friction & (supports == "springs" and not damped and not system.per_apart.any()))


def corners_push_apart(feedback: Feedback) -> bool:
    """Whether the mesh drives motions off the line of action without friction: by tip corners."""
    tilt = feedback.system.cycle.elements.tilt
    return tilt is not None and bool(tilt.coefficients.any())


class FeedbackMultipliers(NamedTuple):
    """Multipliers of the feedback block at k points.

    Attributes
    ----------
    values, errors : (k, 2m) multipliers with proven bounds
    symplectic : (k,) whether the block is symplectic
    """

    values: ComplexArray
    errors: FloatArray
    symplectic: BoolArray


def stays_bounded(
    block: FeedbackMultipliers, off_line: OffLineOfAction, periods: FloatArray, *, driven: bool
) -> BoolArray:
    """Whether motions neither all die out nor grow (k,): PROVEN, see docs/theory/floquet.md.

    Parameters
    ----------
    block : multipliers of the feedback block, which does not read motions off the line of action
    off_line : motions off the line of action
    periods : (k,) [s]
    driven : whether the mesh drives motions off the line of action without friction, `corners_push_apart`
    """
    on_circle = block.symplectic & separate_from_mirror_images(block.values, block.errors)
    inside = (np.abs(block.values) + block.errors < 1.0).all(axis=1)
    exponents = off_line.exponents
    undamped = (exponents.real == 0.0) & (exponents.imag != 0.0)
    fade = exponents.real + off_line.errors < 0.0
    if driven:  # an undamped motion grows where it has a multiplier of the block
        on_circle &= _apart(block, undamped, *off_line.multipliers(periods))
    return np.asarray((undamped | fade).all() & (on_circle | (inside & undamped.any())))


def _apart(
    block: FeedbackMultipliers, chosen: BoolArray, values: ComplexArray, errors: FloatArray
) -> BoolArray:
    """Whether the disks of the chosen multipliers (k, n) of ``values`` meet no disk of the block, (k,)."""
    distance = np.abs(block.values[:, :, None] - values[:, None, chosen])
    reach = (block.errors[:, :, None] + errors[:, None, chosen]) * (1.0 + 1e-9) + 64.0 * _U
    return np.asarray((distance > reach).all(axis=(1, 2)))


def _leading_modes(system: LTVSystem, misfit: FloatArray) -> Feedback:
    """The modes of largest importance of a pair on shafts; the other modes are separate."""
    m = system.deflection.size
    mesh = system.cycle.mean_stiffness * np.outer(system.deflection, system.deflection)
    system = _in_modes(system, eigh(mesh - system.constant[m:, :m])[1])
    all_modes = _in_modes(system, _turn(system))
    order = np.argsort(-importance(all_modes), kind="stable")
    leading, separate_modes = (np.sort(part) for part in (order[:MODES], order[MODES:]))
    separate = -0.5 * np.diag(all_modes.constant[m:, m:])[separate_modes], _squares(all_modes)[separate_modes]
    return Feedback(_in_modes(all_modes, np.eye(m)[:, leading]), np.ones(leading.size), separate, misfit)


def _in_modes(system: LTVSystem, modes: FloatArray) -> LTVSystem:
    """The system in new coordinates. The orthonormal columns of ``modes`` (m, k) are the unit vectors."""
    both = block_diag(modes, modes)
    return replace(
        system,
        coordinates=tuple(f"mode_{j + 1}" for j in range(modes.shape[1])),
        constant=both.T @ system.constant @ both,
        torque_pinion=system.torque_pinion @ both,
        torque_gear=system.torque_gear @ both,
        deflection=system.deflection @ modes,
        reduction=modes.T @ system.reduction,
        gears=system.gears @ modes,
        gyroscopic=modes.T @ system.gyroscopic @ modes,
    )


def _squares(system: LTVSystem) -> FloatArray:
    """Squares of the natural frequencies (m,) with the mean stiffness of the mesh, without friction."""
    v = system.deflection
    m = v.size
    return np.asarray(system.cycle.mean_stiffness * v**2 - np.diag(system.constant[m:, :m]))


def _turn(system: LTVSystem) -> FloatArray:
    """Combinations (m, m) of modes of equal frequency.

    One combination has all deflection, another combination all gyroscopic moments.
    """
    squares = _squares(system)
    combinations = np.eye(squares.size)
    for group in np.split(
        np.arange(squares.size), 1 + np.flatnonzero(np.diff(squares) > _EQUAL * squares[1:])
    ):
        block = np.ix_(group, group)
        first = system.deflection[group]
        leading = np.column_stack([first, system.gyroscopic[block] @ first, np.eye(group.size)])
        leading /= np.maximum(np.linalg.norm(leading, axis=0), np.finfo(float).tiny)
        combinations[block] = np.linalg.qr(leading)[0]
    return combinations


def importance(system: LTVSystem) -> FloatArray:
    """Importance (m,) of each mode on shafts for the deflection of the mesh.

    The share of the mode in the static deflection by the mesh, plus the shares of other modes that damping
    and gyroscopic moments couple to the mode. The coupling is taken at the speed at which the mesh frequency
    is the frequency of the mode.
    """
    v = system.deflection
    squares = _squares(system)
    g = system.pair.geometry
    share = v**2 / squares / (v**2 / squares).sum()
    omega = np.sqrt(squares)
    m = squares.size
    damping = system.constant[m:, m:] + g.omega_pinion * system.gyroscopic
    coupling = omega * (np.abs(damping) + omega / system.pair.pinion.teeth * np.abs(system.gyroscopic))
    distance = np.maximum(np.abs(squares[:, None] - squares), coupling + np.finfo(float).tiny)
    ratio = coupling / distance
    np.fill_diagonal(ratio, 0.0)
    return np.asarray(share + np.square(ratio) @ share)


def gear_block(
    source: AnyPair | GearVariation, rtol: float = 1e-11, *, supports: Supports | None = None
) -> RankOneSystem:
    """Return z = (q, x_p, x_g) of a gear pair, or on shafts modes: z'' + D z' + L z + w v.z + wd v.z' = 0.

    v . z is the dynamic transmission error, on springs with v = (1, 1, -1). w and wd are the effects of
    normal load and friction of all pairs on each coordinate. Torques and unloaded tooth errors force the
    motion and do not change its stability. The metric makes the frictionless mesh symmetric: (m_e, m_p, m_g)
    on springs, and one for modes, which have unit modal mass.

    Parameters
    ----------
    source : a gear pair, or a variation from a chart
    rtol : error of the fitted polynomials relative to the largest gain, which is part of the error bounds
    supports : of a pair: "springs", its ``bearings``, or its "shafts"; by default the shafts if it has them
    """
    rtol = real_number("rtol", rtol, 1e-14, 0.1)
    variation = GearVariation.of(source, supports)
    return fitted_block(feedback_system(variation), variation.stiffness_variation, rtol, [])


def fitted_block(
    feedback: Feedback,
    factor: float,
    rtol: float,
    levels: Sequence[float],
    acts: Intervals | None = None,
) -> RankOneSystem:
    """Feedback with its gains as polynomials; ``factor``, ``levels`` and ``acts`` as in `MeshGains`.

    With levels, the part of the gains that is proportional to mu is ``varied``: a factor on mu then needs no
    new fit. With two levels mu may also rise and fall as a whole.
    """
    system = feedback.system
    metric = feedback.metric
    m = feedback.metric.size
    turning = system.pair.geometry.omega_pinion * system.gyroscopic
    mesh = MeshGains(system, metric, feedback.misfit, factor, levels, acts)
    fits = fit_pieces(mesh, mesh.edges, metric, rtol=rtol)
    jumps = np.zeros((fits.phases.size, mesh.jumps.shape[0]))
    jumps[fits.edge_indices] = mesh.jumps.T
    polynomials = fits.polynomials
    parts = [
        Gains(polynomials[k], polynomials[k + 1], fits.errors[:, k : k + 2], jumps[:, k : k + 2])
        for k in range(0, len(polynomials), 2)
    ]
    return RankOneSystem(
        stiffness=-system.constant[m:, :m],
        damping=-system.constant[m:, m:] - turning,
        v=system.deflection,
        phases=fits.phases,
        gains=parts[0],
        period=system.period,
        metric=metric,
        varied=tuple(parts[1:]),
        gyroscopic=system.period * turning if turning.any() else None,
    )


@dataclass(frozen=True, eq=False, repr=False)
class GearPairMultipliers(Spectrum):
    """Multipliers of a gear pair over one mesh cycle, 10 in all; on shafts two for each mode.

    Of `single_degree` there are two.

    The double +1 of the free rotation is not included: angle and speed of the pair are arbitrary.

    Attributes
    ----------
    feedback : (6,) of q = r_bp theta_p - r_bg theta_g, x_p, x_g, which alone can become unstable; on shafts
        of the modes of largest importance
    oloa : (4,) of y_p and y_g, two each. Friction drives these motions, and they have no effect on the other
        coordinates: the bearings alone decide the multipliers. On shafts of each of the other modes
    variation : the pair with the changes of the chart point
    """

    feedback: ComplexArray
    oloa: ComplexArray
    variation: GearVariation

    @cached_property
    def liouville_residual(self) -> float:
        """Product of ``feedback`` less exp of the integral of tr A(t) over the period (Liouville's formula).

        The integral takes A(t) of the lumped model, independently of the compiled kernel. Where damping
        leaves little of a motion in one period, product and integral are close to 0 and the residual says
        little.
        """
        system = gear_pair_system(self.variation, "mesh")
        edges = np.array([0.0, *system.breakpoints, system.period])
        expected = np.exp(integral_of_trace(system, edges))
        return float(abs(np.prod(self.feedback) - expected))


def gear_pair_system(
    source: AnyPair | GearVariation, form: Form = "elastic", *, supports: Supports | None = None
) -> PeriodicSystem:
    """Return the gear pair (or a variation of it) as a `PeriodicSystem`.

    Parameters
    ----------
    source : the pair
    form : "elastic" (10 states), "mesh" (6) or "full" (12), as in ``lumped.periodic_system``; on
        shafts more, and "mesh" with the modes that count only, see `gear_pair_multipliers`
    supports : of a pair: "springs", its ``bearings``, or its "shafts"; by default the shafts if it has them
    """
    variation = GearVariation.of(source, supports)
    one_of("form", form, get_args(Form))
    if form == "mesh":
        system = feedback_system(variation).system
    else:
        system = LTVSystem.of(variation.pair, form, cycle=variation.cycle(), supports=variation.supports)
    coefficients = _Coefficients(system, variation.stiffness_variation)
    return PeriodicSystem(coefficients, system.period, tuple(system.breakpoints), vectorized=True)


@dataclass(frozen=True, eq=False)
class _Coefficients:
    """A(t) strictly inside the smooth segments, with the total mesh stiffness mean + factor (k - mean).

    Every pair keeps the share of the stiffness: k_i is multiplied by f = (mean + factor (k - mean))/k. The
    damping c_i is proportional to sqrt(k_i) and is multiplied by sqrt(f).
    """

    system: LTVSystem
    factor: float

    def __call__(self, times: FloatArray) -> FloatArray:
        system = self.system
        edges = self.system.cycle.edges
        # The mesh cycle by itself takes a time just before a switch as the switch: name the segment.
        segment = np.clip(np.searchsorted(edges, times, side="right") - 1, 0, edges.size - 2)
        gain = system.gain(times, segment)
        stiffness = gain.stiffness
        damping = gain.damping
        if self.factor != 1.0:
            total = gain.pairs.stiffness.sum(axis=0)
            mean = system.cycle.mean_stiffness
            f = ((mean + self.factor * (total - mean)) / total)[:, None]
            stiffness = f * stiffness
            damping = np.sqrt(f) * damping
        m = len(system.coordinates)
        A = np.repeat(system.constant[None], times.size, axis=0)
        A[:, m:, :m] += stiffness[:, :, None] * system.deflection
        A[:, m:, m:] += damping[:, :, None] * system.deflection
        return A


@dataclass(frozen=True, eq=False)
class OffLineOfAction:
    """Exponents of the motions y_p, y_g off the line of action, or of separate modes on shafts; closed form.

    m y'' + c y' + K y = 0 for each motion: s = -d +- sqrt(r), d = c/(2 m), r = d^2 - K/m. The multipliers are
    exp(s T), with PROVEN bounds on their errors.

    Attributes
    ----------
    exponents : (4,) s [1/s]; on shafts two for each mode
    errors : (4,) bounds on their errors for m, c and K that are right to rounding [1/s]. With e a bound on
        the error of r, sqrt(r) is wrong by at most min(sqrt e, e/sqrt |r|): at critical damping by sqrt e.
    """

    exponents: ComplexArray
    errors: FloatArray

    @classmethod
    def of(cls, feedback: Feedback) -> OffLineOfAction:
        """Exponents of the motions that the mesh does not couple."""
        decay, square = feedback.separate
        r = decay**2 - square
        root = np.sqrt(r.astype(complex))
        # Twelve units of rounding: those of m, c and K, of d^2, of K/m and of the difference.
        e = 12.0 * _U * (decay**2 + square)
        with np.errstate(divide="ignore", invalid="ignore"):
            root_error = np.minimum(np.sqrt(e), np.where(r == 0.0, np.inf, e / np.abs(root)))
        errors = root_error + 4.0 * _U * (decay + np.abs(root))
        return cls(np.concatenate([-decay + root, -decay - root]), np.concatenate([errors, errors]))

    def multipliers(self, periods: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """Multipliers over periods (N,) -> (N, 4), and bounds on their errors."""
        angle = self.exponents * periods[:, None]
        values = np.exp(angle)
        # Sixteen units: the product, and periods that are made of speeds in rpm.
        exponent_error = self.errors * periods[:, None] + 16.0 * _U * np.abs(angle)
        return values, np.abs(values) * (np.expm1(exponent_error) + 8.0 * _U)


def gear_pair_multipliers(
    source: AnyPair | GearVariation,
    rtol: float = 1e-10,
    *,
    method: str | Propagator = "taylor",
    supports: Supports | None = None,
) -> GearPairMultipliers:
    """Floquet multipliers of a gear pair over one mesh cycle, of its linear form with like teeth.

    The equations of y_p and y_g contain q, x_p, x_g, but the equations of q, x_p, x_g do not contain y_p and
    y_g. The 10 x 10 matrix is therefore block triangular: the multipliers are the multipliers of the 6 x 6
    feedback block and of the bearings of y. On shafts gyroscopic moments couple both ways. The feedback block
    then has the 12 modes of largest importance for the motion of the mesh. The bounds are valid for a system
    in which each other mode moves independently.

    Parameters
    ----------
    source : a gear pair, or a variation from a chart
    rtol : wanted error of the monodromy matrix relative to its norm, 1e-13 to 1e-1
    method : "taylor", the compiled kernel, whose bound is proven; or a method of `monodromy` on A(t) as a
        callable, for an independent estimate
    supports : of a pair: "springs", its ``bearings``, or its "shafts"; by default the shafts if it has them

    Returns
    -------
    GearPairMultipliers

    Raises
    ------
    ParameterError : rtol out of range, unknown method or supports
    NumericalError : as in `monodromy`
    """
    variation = GearVariation.of(source, supports)
    rtol = real_number("rtol", rtol, 1e-13, 0.1)
    feedback = feedback_system(variation)
    off_line = OffLineOfAction.of(feedback)
    spectrum: Spectrum
    if isinstance(method, str) and method == "taylor":
        spectrum = _proven(feedback, variation, rtol)
        block = FeedbackMultipliers(
            spectrum.multipliers[None], spectrum.multiplier_errors[None], np.array([spectrum.symplectic])
        )
        driven = corners_push_apart(feedback)
        bounded = bool(stays_bounded(block, off_line, np.array([spectrum.period]), driven=driven)[0])
    else:
        spectrum = monodromy(gear_pair_system(variation, "mesh"), rtol, method=method)
        bounded = False
    (oloa,), (oloa_errors,) = off_line.multipliers(np.array([spectrum.period]))
    values = np.concatenate([spectrum.multipliers, oloa])
    errors = np.concatenate([spectrum.multiplier_errors, oloa_errors])
    order = np.argsort(-np.abs(values), kind="stable")
    return GearPairMultipliers(
        multipliers=values[order],
        multiplier_errors=errors[order],
        period=spectrum.period,
        feedback=spectrum.multipliers,
        oloa=oloa,
        variation=variation,
        certificate=spectrum.certificate,
        symplectic=spectrum.symplectic,
        neutral=bounded,
    )


def _proven(feedback: Feedback, variation: GearVariation, rtol: float) -> Spectrum:
    """Multipliers of the feedback block by the compiled kernel."""
    block = fitted_block(feedback, variation.stiffness_variation, max(0.01 * rtol, 1e-13), [])
    friction = np.array(feedback.system.cycle.elements.friction.coefficients.any())
    symplectic = variation.pair.mesh.damping_ratio == 0.0 and bool(
        stays_symmetric(feedback, variation.supports, friction)
    )
    result = fast_multipliers(block, tolerance=max(1e-4 * rtol, 1e-14))
    order = np.argsort(-np.abs(result.multipliers[0]), kind="stable")
    return Spectrum(
        result.multipliers[0][order],
        result.errors[0][order],
        block.period,
        certificate="proven",
        symplectic=symplectic,
    )


@dataclass(frozen=True, eq=False, repr=False)
class RevolutionMultipliers(DisplayedResult):
    """Floquet multipliers over the period of teeth that differ.

    Multipliers smaller than the bound on their error are left out.

    Attributes
    ----------
    multipliers : over the whole period, largest first; 0 where they are below the smallest number
    rates : |multiplier|^(1/cycles), growth of each motion in one mesh cycle
    rate : the largest rate; above 1 the motion is unstable
    error : bound on the error of ``rate``, proven for the polynomials of the gains of every mesh cycle
    cycles : mesh cycles of the period
    healthy_rate : rate of the twin with like teeth, by the same method
    certificate : "proven"
    """

    multipliers: ComplexArray
    rates: FloatArray
    rate: float
    error: float
    cycles: int
    healthy_rate: float
    certificate: Certificate = "proven"

    @property
    def stable(self) -> bool:
        """Whether the rate is below 1 by more than the error of the rate: perturbations fade."""
        return self.rate + self.error < 1.0


def revolution_multipliers(
    pair: AnyPair, rtol: float = 1e-10, *, supports: Supports | None = None
) -> RevolutionMultipliers:
    """Multipliers over a revolution or hunting period of teeth that differ: docs/theory/teeth.md.

    Each tooth pair has its own static state, and perturbations see the tangent of the contact about this
    state. The maps of the mesh cycles are multiplied one after the other and scaled, so that a hunting period
    of thousands of cycles neither overflows nor underflows. Motions that the mesh does not couple have
    separate multipliers: y_p and y_g off the line of action, or on shafts all modes but the 12 most important
    modes of `gear_pair_multipliers`.

    Parameters
    ----------
    pair : a validated gear pair
    rtol : wanted error of the map of a mesh cycle relative to its norm, 1e-11 to 1e-1
    supports : "springs", the four of ``bearings``, or "shafts", the elastic ones of ``shafts``; by default
        the shafts of a pair that has them

    Raises
    ------
    ParameterError : rtol out of range
    NumericalError : at some position no tooth pair can carry the load
    """
    pair = load_gear_pair(pair)
    rtol = real_number("rtol", rtol, 1e-11, 0.1)
    feedback = feedback_system(GearVariation.of(pair.healthy, supports))
    like_teeth = fitted_block(feedback, 1.0, max(0.01 * rtol, 1e-13), [])
    cycles = period_of(pair)
    laws = ToothLaws(pair, every=True)
    # Errors of the teeth force prescribed contact and do not change it.
    alike = not laws.loaded and len(laws.faults) == 1 and not laws.turning()["amplitude"][:RIPPLES].any()
    healthy = float(_of_cycles(ToothLaws(pair.healthy, every=True), feedback, like_teeth, 1, 1, rtol)[1][0])
    # The product of so many cycles does not vanish, and the kernel has enough steps for them.
    longest = min(
        _SMALLEST / np.log(min(healthy, 0.99)),
        4e4 / (1e3 + like_teeth.modal().omega.max() * like_teeth.period),
    )
    block = int(np.clip(longest, 1, _BLOCK))
    values, rates, error = _of_cycles(laws, feedback, like_teeth, 1 if alike else cycles, block, rtol)
    with np.errstate(under="ignore"):
        over_period = values**cycles if alike else values
    # What the mesh does not couple has the same multipliers with any teeth.
    off_line = OffLineOfAction.of(feedback)
    (separate,), (bounds,) = off_line.multipliers(np.array([like_teeth.period]))
    sizes = np.abs(separate)
    high = max(float(rates[0]) + error, float((sizes + bounds).max(initial=0.0)))
    low = max(float(rates[0]) - error, float((sizes - bounds).max(initial=0.0)))
    over_period = np.append(over_period, separate**cycles)
    rates = np.append(rates, sizes)
    order = np.argsort(-rates, kind="stable")
    rate = float(rates[order[0]])
    error = max(high - rate, rate - low)
    healthy = max(healthy, float(sizes.max(initial=0.0)))
    return RevolutionMultipliers(over_period[order], rates[order], rate, error, cycles, healthy)


def _of_cycles(
    laws: ToothLaws, feedback: Feedback, like: RankOneSystem, cycles: int, block: int, rtol: float
) -> tuple[ComplexArray, FloatArray, float]:
    """Multipliers over ``cycles`` mesh cycles, largest first, and their rates.

    The third result is a PROVEN bound on the error of the largest rate. ``block`` cycles at a time are one
    period of the kernel.
    """
    tables = own_tables(laws)
    mean = like.mean_of(like.gains.w)

    def map_of(first: int) -> FastMonodromy:
        count = min(block, cycles - first)
        gains = OwnGains(tables, feedback.system, first, count)
        fits = fit_pieces(gains, gains.edges, feedback.metric, rtol=0.1 * rtol)
        w, wd = fits.polynomials
        period = count * like.period
        block_gains = Gains(w, wd, fits.errors)
        turning = None if like.gyroscopic is None else count * like.gyroscopic
        cycles_of_block = replace(
            like, phases=fits.phases / count, gains=block_gains, period=period, gyroscopic=turning, mean=mean
        )
        return fast_monodromies(cycles_of_block, tolerance=max(1e-4 * rtol, 1e-14))

    flows = in_threads(map_of, range(0, cycles, block))
    maps, errors = (np.concatenate([getattr(f, name) for f in flows]) for name in ("matrices", "errors"))
    # Powers of two scale without rounding.
    flow = np.eye(maps.shape[1])
    halvings = np.zeros(errors.size, dtype=np.int64)
    for n, cycle_map in enumerate(maps):
        flow = cycle_map @ flow
        halvings[n] = np.frexp(np.abs(flow).max())[1]
        flow = np.ldexp(flow, -halvings[n])
    scaled = np.ldexp(maps, -halvings[:, None, None])
    values, bounds = multipliers_with_bounds(*proven_product(scaled, np.ldexp(errors, -halvings)))
    radius, error = map(float, radii_with_bounds(values, bounds))
    significant = values[(np.abs(values) > bounds) | (values == values[0])]
    logarithm = float(halvings.sum()) * np.log(2.0)
    interval = [max(radius - error, 0.0), radius + error]
    with np.errstate(under="ignore", divide="ignore"):
        rates, (low, high) = (
            np.exp((np.log(m) + logarithm) / cycles) for m in (np.abs(significant), interval)
        )
        over_period = significant * np.exp(min(logarithm, _LARGEST))
    rounding = 8.0 * _U * (2.0 + abs(np.log(high))) * high
    return over_period, rates, float(max(high - rates[0], rates[0] - low) + rounding)
