"""Floquet multipliers by two routes that share no code but the laws of the tooth pairs.

One is the multibody model's flow map: runs over one mesh cycle from perturbed states, with kinematics,
damping and friction of its own. The other are the engines of ``floquet``. Matrices are compared where both
have them, else the coefficients of the characteristic polynomial, which unlike multipliers do not spread
where two of them meet. 1 % of any coefficient changes either by 1e-4 and more; runs are good to 1e-8.
"""

import itertools
from collections.abc import Iterator

import numpy as np

import multibody
from floquet import fast_multipliers, gear_block, gear_pair_multipliers, gear_pair_system, monodromy
from lumped import GearPair
from lumped.model.periodic_system import periodic_system
from tests.evidence.check import Check
from tests.evidence.floquet.extended import as_periodic_system

#: Rows of q, x_p, x_g with their rates among the ten relative states.
_FEEDBACK = [0, 1, 2, 5, 6, 7]
#: Places in each piece of the fitted gains.
_PLACES = 25


def stability_routes(pair: GearPair) -> Iterator[Check]:
    """Monodromy matrix and compiled multipliers against the flow map; the blocks; the misfit."""
    flow = multibody.monodromy(pair, fidelity="linear", rtol=1e-8)
    elastic = monodromy(gear_pair_system(pair, "elastic"), rtol=1e-9)
    rates = np.concatenate([np.ones(5), np.full(5, pair.geometry.mesh_period / (2.0 * np.pi))])
    a, b = (matrix * rates[:, None] / rates for matrix in (elastic.matrix, flow.matrix))
    error = float(np.linalg.norm(a - b) / np.linalg.norm(b))
    yield Check("monodromy matrix", "the multibody model's flow map; over its norm", error, 1e-5)
    compiled = fast_multipliers(gear_block(pair)).multipliers[0]
    own = np.linalg.eigvals(flow.matrix[np.ix_(_FEEDBACK, _FEEDBACK)])
    ours, theirs = (np.real(np.poly(values)) for values in (compiled, own))
    error = float(np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs)))
    exact = "that of the flow map; over its largest coefficient"
    yield Check("characteristic polynomial of the compiled multipliers", exact, error, 1e-5)
    block = gear_pair_multipliers(pair, rtol=1e-9)
    gap = np.abs(elastic.multipliers[:, None] - block.multipliers[None, :]).min(axis=1)
    # Close multipliers spread the error of the matrix, 1e-9, by its root at worst.
    exact = "those of the ten states; absolute"
    yield Check("multipliers by blocks, those of y in closed form", exact, float(gap.max()), 1e-6)
    yield fit_bound(pair)


def fit_bound(pair: GearPair) -> Check:
    """The misfit that the compiled multipliers' bound counts with, against the gains of A(t) themselves."""
    block = gear_block(pair)
    system = periodic_system(pair, "mesh")
    fitted = as_periodic_system(block)
    m = block.v.size
    ends = block.phases * block.period
    u = np.linspace(-1.0, 1.0, _PLACES + 2)[1:-1]
    used = 0.0
    for piece, (low, high) in enumerate(itertools.pairwise(ends.tolist())):
        times = 0.5 * (low + high) + 0.5 * (high - low) * u
        apart = (np.asarray(fitted.A(times), dtype=float) - system.matrices(times))[:, m:]
        # w and wd stand in every column, times v: in that of q times 1.
        for gain, column in enumerate((0, m)):
            size = float(np.sqrt(block.metric @ apart[:, :, column].T ** 2).max())
            bound = float(block.total.fit_errors[piece, gain])
            used = max(used, size / bound if bound > 0.0 else np.inf if size > 0.0 else 0.0)
    exact = f"A(t) at {_PLACES} times in each piece; largest error over its bound"
    return Check("misfit of the polynomials in the compiled multipliers", exact, used, 1.0)
