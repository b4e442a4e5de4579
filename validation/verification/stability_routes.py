"""Floquet multipliers by two routes that share no code but the laws of the tooth pairs.

One is the multibody model's flow map: runs over one mesh cycle from perturbed states, with kinematics,
damping and friction of its own. The other are the engines of ``floquet``. Matrices are compared where both
have them, else the coefficients of the characteristic polynomial, which unlike multipliers do not spread
where two of them meet.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

import multibody
from floquet import fast_multipliers, gear_block, gear_pair_system, monodromy
from lumped import GearPair
from lumped.model.periodic_system import periodic_system
from lumped.typing import ComplexArray
from validation.verification.checks import Check, check

#: Rows of q, x_p, x_g and of y_p, y_g, with their rates, among the ten relative states.
_FEEDBACK, _OLOA = [0, 1, 2, 5, 6, 7], [3, 4, 8, 9]
#: Tolerance of the runs: a hundredth of the limits and less.
_RTOL = 1e-8
#: Places in each piece of the fitted gains.
_PLACES = 25


@dataclass(frozen=True, eq=False)
class StabilityRoutes:
    """The multipliers by the multibody model's flow map, compared with those of ``floquet``.

    Attributes
    ----------
    feedback, oloa : (6,), (4,) multipliers of q, x_p, x_g and of y_p, y_g, with their rates
    checks : comparison of the characteristic polynomials, and of the whole monodromy matrices
    """

    feedback: ComplexArray
    oloa: ComplexArray
    checks: tuple[Check, ...]

    @property
    def agree(self) -> bool:
        """Whether both comparisons are within their limits."""
        return all(check.passes for check in self.checks)


def stability_routes(pair: GearPair) -> StabilityRoutes:
    """Compare the monodromy matrix and the compiled multipliers with the multibody model's flow map.

    Parameters
    ----------
    pair : a validated gear pair

    Raises
    ------
    NumericalError : the flow map cannot be computed
    """
    flow = multibody.monodromy(pair, fidelity="linear", rtol=_RTOL)
    general = monodromy(gear_pair_system(pair, "elastic"), rtol=1e-9).matrix
    period = pair.geometry.mesh_period
    rates = np.concatenate([np.ones(5), np.full(5, period / (2.0 * np.pi))])
    a, b = (matrix * rates[:, None] / rates for matrix in (general, flow.matrix))
    compiled = fast_multipliers(gear_block(pair)).multipliers[0]
    own, oloa = (np.linalg.eigvals(flow.matrix[np.ix_(r, r)]).astype(complex) for r in (_FEEDBACK, _OLOA))
    ours, theirs = (np.real(np.poly(values)) for values in (compiled, own))
    checks = (
        check("flow_map", float(np.linalg.norm(a - b) / np.linalg.norm(b))),
        check("compiled_multipliers", np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs))),
    )
    return StabilityRoutes(own, oloa, checks)


def fit_bound(pair: GearPair) -> Check:
    """The misfit that the compiled multipliers' bound counts with, against the gains of A(t) themselves.

    Parameters
    ----------
    pair : a validated gear pair
    """
    block, system = gear_block(pair), periodic_system(pair, "mesh")
    fitted, m = block.to_periodic_system(), block.v.size
    ends, u = block.phases * block.period, np.linspace(-1.0, 1.0, _PLACES + 2)[1:-1]
    used = 0.0
    for piece, (low, high) in enumerate(itertools.pairwise(ends.tolist())):
        times = 0.5 * (low + high) + 0.5 * (high - low) * u
        apart = (np.asarray(fitted.A(times), dtype=float) - system.matrices(times))[:, m:]
        # w and wd stand in every column, times v: in that of q times 1.
        for gain, column in enumerate((0, m)):
            size = float(np.sqrt(block.metric @ apart[:, :, column].T ** 2).max())
            bound = float(block.total.fit_errors[piece, gain])
            used = max(used, size / bound if bound > 0.0 else np.inf if size > 0.0 else 0.0)
    return check("misfit", used, places=_PLACES)
