"""Floquet multipliers by two routes that share no code but the laws of the tooth pairs.

One is the multibody model's flow map: runs over one mesh cycle from perturbed states, with kinematics,
damping and friction of its own. The other are the engines of ``floquet``. Matrices are compared where both
have them, else the coefficients of the characteristic polynomial, which unlike multipliers do not spread
where two of them meet.
"""

from __future__ import annotations

import numpy as np

import multibody
from floquet import fast_multipliers, gear_block, gear_pair_system, monodromy
from lumped import GearPair
from validation.verification.checks import Check

#: Rows of q, x_p, x_g and their rates among the ten relative states.
_FEEDBACK = [0, 1, 2, 5, 6, 7]
#: Limit of both; 1 % of a coefficient changes them by 1e-3 and more.
LIMIT = 1e-5


def stability_routes(pair: GearPair) -> tuple[Check, Check]:
    """Compare the monodromy matrix and the compiled multipliers with the multibody model's flow map.

    Parameters
    ----------
    pair : a validated gear pair

    Raises
    ------
    NumericalError : the flow map cannot be computed
    """
    flow = multibody.monodromy(pair, fidelity="linear")
    general = monodromy(gear_pair_system(pair, "relative"), rtol=1e-9).matrix
    period = pair.geometry.mesh_period
    rates = np.concatenate([np.ones(5), np.full(5, period / (2.0 * np.pi))])
    a, b = (matrix * rates[:, None] / rates for matrix in (general, flow.matrix))
    compiled = np.real(np.poly(fast_multipliers(gear_block(pair)).multipliers[0]))
    own = np.real(np.poly(flow.matrix[np.ix_(_FEEDBACK, _FEEDBACK)]))
    exact = "the flow map of the multibody model, by runs from perturbed states"
    reason = "central differences of runs to 1e-10; 1 % of one coefficient changes it a hundred times as much"
    return (
        Check(
            key="flow_map",
            subject="monodromy matrix of this pair",
            exact=f"{exact}; over its norm",
            value=float(np.linalg.norm(a - b) / np.linalg.norm(b)),
            limit=LIMIT,
            reason=reason,
        ),
        Check(
            key="compiled_multipliers",
            subject="compiled multipliers of this pair, their characteristic polynomial",
            exact=f"that of {exact}; over its largest coefficient",
            value=float(np.max(np.abs(compiled - own)) / np.max(np.abs(own))),
            limit=LIMIT,
            reason=reason,
        ),
    )
