"""A sample of the judge, and faults that it must find. In full: see court.py."""

import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("flint", reason="needs python-flint (extra: test)")
sys.path.insert(0, str(Path(__file__).parent))

from balls import exact_multipliers, worst_ratio
from court import judge
from gears import pieces

from floquet import fast_multipliers, gear_block
from lumped import GearPair, load_gear_pair
from lumped.model.mesh_cycle import MeshCycle


@pytest.mark.parametrize("kind", ["rectangular", "wild table", "collision", "formula"])
def test_a_sample_of_bounds_and_verdicts(kind: str) -> None:
    for finding in judge(kind, 4):
        assert finding.ratio <= 1.0, finding
        assert not finding.wrong, finding
        assert finding.ratio > 0.0 or finding.kind != "formula"  # the truth is not the answer itself


def wild_pair() -> GearPair:
    pair = load_gear_pair("nasa_28_28").with_(
        {"mesh.contact": "prescribed", "friction.law": "coulomb", "mesh.damping_ratio": 0.02}
    )
    stiffness = 60e6 * (1.0 + 0.2 * np.cos(np.linspace(0.0, 6.0, 40)))
    stiffness[17] *= 3.0
    table = {
        "model": "table", "axis": "phase", "stiffness": stiffness.tolist(),
        "points": np.linspace(0.0, pair.geometry.contact_ratio, 40).tolist(),
    }  # fmt: skip
    return pair.with_({"mesh.stiffness": table})


def test_faults_in_the_bound_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    pair = wild_pair()
    truth = exact_multipliers(partial(pieces, pair), 6)

    def ratio(values: np.ndarray, errors: np.ndarray) -> float:
        return worst_ratio(values[0], errors[0], truth)[0]

    sound = fast_multipliers(gear_block(pair))
    assert ratio(sound.multipliers, sound.errors) <= 1.0
    # The tail of the series, dropped: computed loosely, with the bound of a sharp one.
    loose = fast_multipliers(gear_block(pair), tolerance=1e-3)
    assert ratio(loose.multipliers, loose.errors) <= 1.0 < ratio(loose.multipliers, sound.errors)
    # The misfit of the gains, dropped.
    coarse = gear_block(pair, rtol=1e-3)
    silent = replace(coarse, gains=replace(coarse.gains, fit_errors=np.zeros_like(coarse.gains.fit_errors)))
    result = fast_multipliers(coarse)
    blind = fast_multipliers(silent)
    assert ratio(result.multipliers, result.errors) <= 1.0 < ratio(blind.multipliers, blind.errors)
    # The knots, ignored: not in the pieces alone, since their distance to the ends of pieces is in the bound.
    monkeypatch.setattr(MeshCycle, "breaks", property(lambda cycle: cycle.edges))
    assert fast_multipliers(gear_block(pair)).errors.min() > 1.0
    monkeypatch.setattr(MeshCycle, "break_phases", property(lambda cycle: cycle.edges[:-1] / cycle.period))
    missed = fast_multipliers(gear_block(pair))
    assert ratio(missed.multipliers, missed.errors) > 1.0
