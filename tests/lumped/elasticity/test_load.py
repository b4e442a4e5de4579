"""Does the load without its singularity move the tooth as an explicit Hertzian pressure on a fine mesh?"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import splu

from lumped.elasticity.elements import assembled, line_shapes
from lumped.elasticity.load import flank_load
from lumped.elasticity.sector import sector, stations

from .conftest import NU

LENGTH, HALF_WIDTH = 3.0, 0.03


def refined(ends, centre, smallest):
    """Ends of elements that shrink towards a point."""
    while True:
        middle, size = 0.5 * (ends[1:] + ends[:-1]), np.diff(ends)
        away = np.maximum(abs(middle - centre) - 0.5 * size, 0.0)
        large = size > np.maximum(smallest, 0.6 * away) * 1.001
        if not large.any():
            return ends
        ends = np.sort(np.concatenate([ends, middle[large]]))


def with_middles(ends):
    full = np.empty(2 * ends.size - 1)
    full[::2], full[1::2] = ends, 0.5 * (ends[1:] + ends[:-1])
    return full


class Pitch:
    """One pitch that is held at its bore and both cuts."""

    def __init__(self, mesh):
        self.mesh = mesh
        held = np.unique(np.concatenate([mesh.bore, mesh.behind, mesh.ahead]))
        self.kept = np.setdiff1d(np.arange(2 * len(mesh.nodes)), np.concatenate([2 * held, 2 * held + 1]))
        matrix, _ = assembled(mesh.nodes, mesh.elements, NU)
        self.factor = splu(matrix[self.kept][:, self.kept])

    def work(self, read, load):
        return read[self.kept] @ self.factor.solve(load[self.kept])

    def subtracted(self, length, **options):
        load, read, _ = flank_load(self.mesh, NU, length, **options)
        return self.work(read, load)

    def pressed(self, length, half_width):
        """Deflection under p = 2/(pi a) sqrt(1 - (s/a)^2), s along the flank from the load's point."""
        mesh = self.mesh
        _, read, _ = flank_load(mesh, NU, length)
        _, _, point, _ = mesh.edge_at(length)
        load = np.zeros(read.size)
        x, w = np.polynomial.legendre.leggauss(12)
        shapes, slopes = line_shapes(x)
        for edge in mesh.flank:
            at, along = shapes @ mesh.nodes[edge], slopes @ mesh.nodes[edge]
            s = np.hypot(*(at - point).T)
            pressure = 2.0 / (math.pi * half_width) * np.sqrt(np.maximum(1.0 - (s / half_width) ** 2, 0.0))
            inward = np.stack([along[:, 1], -along[:, 0]], -1)
            force = np.einsum("p,p,pc,pk->kc", pressure, w, inward, shapes)
            load[2 * edge], load[2 * edge + 1] = (
                load[2 * edge] + force[:, 0],
                load[2 * edge + 1] + force[:, 1],
            )
        total = math.hypot(load[::2].sum(), load[1::2].sum())
        return self.work(read, load) / total


@pytest.fixture(scope="module")
def pitches(small):
    tip, bore = 0.5 * small.teeth + 1.5, small.root_radius / 4.0
    plain = stations(small, tip, bore, 0.2)
    graded = replace(
        plain,
        lengths=with_middles(refined(plain.lengths[::2], LENGTH, HALF_WIDTH / 4.0)),
        across=with_middles(refined(plain.across[::2], 1.0, HALF_WIDTH / 3.0)),
    )
    return [Pitch(sector(small, tip, bore, at)) for at in (plain, graded)]


def test_the_subtraction_is_the_limit_of_an_explicit_pressure(pitches):
    plain, graded = pitches
    # Johnson (1985), eq. (5.57): under the middle of the pressure the half plane gives
    # (2 ln(2/a) + 1 - (1 + nu))/pi more than the smooth part.
    singular = (2.0 * math.log(2.0 / HALF_WIDTH) - NU) / math.pi
    explicit = graded.pressed(LENGTH, HALF_WIDTH)
    assert graded.subtracted(LENGTH) + singular == pytest.approx(explicit, rel=2e-4)
    assert plain.subtracted(LENGTH) + singular == pytest.approx(explicit, rel=1e-3)


def test_force_and_moment_are_those_of_the_load(pitches):
    plain, _ = pitches
    load, read, _ = flank_load(plain.mesh, NU, LENGTH)
    x, y = plain.mesh.nodes.T
    for axis in (load, read):
        moment = (x * axis[1::2] - y * axis[::2]).sum()
        assert math.hypot(axis[::2].sum(), axis[1::2].sum()) == pytest.approx(1.0, rel=1e-12)
        # The lever of the line of action, but for the edge that interpolates the involute.
        assert -moment == pytest.approx(0.5 * 9 * math.cos(math.radians(20.0)), rel=1e-4)
