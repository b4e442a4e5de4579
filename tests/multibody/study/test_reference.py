"""Does the multibody model's own evidence hold: its damping, its bodies, its third build, its modes?"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import lumped
import multibody
from lumped.model.averaged import modes
from multibody.contact import kernels as kn
from multibody.contact.machine import machine
from multibody.study.outline import gear_outline

ROOT = Path(__file__).parents[3]
#: Nothing alike: teeth, shifts, all damping ratios and bearings.
UNLIKE = lumped.load_gear_pair("fzg_c").with_(
    mesh__damping_ratio=0.07,
    mesh__stiffness={"model": "parabolic"},
    bearings__pinion={
        "loa_stiffness": 2e8,
        "oloa_stiffness": 5e7,
        "loa_damping_ratio": 0.02,
        "oloa_damping_ratio": 0.4,
    },
    bearings__gear={
        "loa_stiffness": 3e8,
        "oloa_stiffness": 1e8,
        "loa_damping_ratio": 1.2,
        "oloa_damping_ratio": 0.03,
    },
)


def test_free_vibration_decays_with_the_damping_ratios_of_the_schema():
    """Under-damped and over-damped: the decay of an oscillator is known exactly."""
    decays = multibody.damping_check(UNLIKE)
    assert [d.motion for d in decays] == ["mesh", "pinion x", "pinion y", "gear x", "gear y"]
    np.testing.assert_allclose([d.given for d in decays], [0.07, 0.02, 0.4, 1.2, 0.03], rtol=1e-14)
    np.testing.assert_allclose([d.measured for d in decays], [d.given for d in decays], rtol=1e-6)
    body, k = lumped.bodies(UNLIKE), UNLIKE.bearings.gear.loa_stiffness
    assert decays[3].frequency == pytest.approx(np.sqrt(k / body.mass_gear) / (2 * np.pi), rel=1e-6)
    assert decays[1].decrement == pytest.approx(2 * np.pi * 0.02, rel=1e-3)
    assert decays[3].decrement == np.inf


def test_a_wrong_damping_constant_is_seen_in_the_decay(monkeypatch):
    def doubled(pair):
        numbers = machine(pair)
        p = numbers.parameters.copy()
        p[kn.DAMPING] *= 2.0
        return replace(numbers, parameters=p, bearing_damping=numbers.bearing_damping[:, ::-1])

    monkeypatch.setattr("multibody.study.free_vibration.machine", doubled)
    measured = [d.measured / d.given for d in multibody.damping_check(UNLIKE)]
    assert measured[0] == pytest.approx(2.0, rel=1e-6)
    assert all(abs(ratio - 1.0) > 0.2 for ratio in measured[1:])


@pytest.mark.parametrize("name", lumped.preset_names())
def test_bodies_by_their_outline(name):
    """The drawn outline has the same flanks and straight fillets; discs stand for gears within a tenth."""
    pair = lumped.load_gear_pair(name)
    for which, blank in zip(("pinion", "gear"), multibody.blanks(pair), strict=True):
        gear = getattr(pair, which)
        x, y = gear_outline(pair, which, points=100).T
        area = 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
        drawn = gear.density * gear.face_width * (area - np.pi * gear.bore**2 / 4.0)
        assert blank.mass == pytest.approx(drawn, rel=2e-2)
        assert blank.error < 1e-6
        assert abs(blank.mass_difference) < 0.03
        assert abs(blank.inertia_difference) < 0.1
        body = lumped.bodies(pair)
        assert blank.taken_mass == pytest.approx(getattr(body, f"mass_{which}"), rel=1e-12)
        assert blank.taken_inertia == pytest.approx(getattr(body, f"inertia_{which}"), rel=1e-12)


def test_a_bore_takes_its_disc_out_of_the_outline():
    pair = lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored")
    solid, bored = multibody.blanks(pair)[0], multibody.blanks(pair.with_(pinion__bore=40.0))[0]
    hole = pair.pinion.density * pair.pinion.face_width * np.pi * 0.02**2
    assert solid.mass - bored.mass == pytest.approx(hole, rel=1e-12)
    assert solid.inertia - bored.inertia == pytest.approx(0.5 * hole * 0.02**2, rel=1e-12)


def test_bodies_that_turn_move_like_those_that_deviate():
    """atol 1e-8 leaves some 1e-11 m, 1e-9 a tenth of that; the angle is the nominal one."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored")
    loose, sharp = (multibody.turning_build(pair, 2, atol=atol) for atol in (1e-8, 1e-9))
    assert loose.difference < 3e-11
    assert sharp.difference < 0.3 * loose.difference
    assert loose.span > 1e-5
    assert loose.turned == pytest.approx(2 * 2 * np.pi / 28)
    assert loose.evaluations[0] < sharp.evaluations[0] < 5000


def test_frozen_modes_are_the_lumped_ones_but_for_the_turned_line():
    found = multibody.frozen_modes(
        lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored"), phase=0.3
    )
    f, zeta = (found[name] for name in ("natural_frequency", "damping_ratio"))
    lumped_f = f.sel(source="lumped frozen").to_numpy()
    np.testing.assert_allclose(lumped_f[[0, -1]], [2237.677, 8691.553], atol=1e-3)
    # exudyn differentiates numerically.
    np.testing.assert_allclose(f.sel(source="exudyn linear"), lumped_f, rtol=1e-7)
    np.testing.assert_allclose(zeta.sel(source="exudyn linear"), zeta.sel(source="lumped frozen"), rtol=1e-6)
    exact, turned = f.sel(source="exudyn exact").to_numpy(), f.sel(source="lumped turned line").to_numpy()
    assert exact[1] - lumped_f[1] == pytest.approx(turned[1] - lumped_f[1], rel=0.01)
    assert turned[1] - lumped_f[1] == pytest.approx(-1.27, abs=0.01)
    np.testing.assert_allclose(exact[[0, 2, 3, 4]], lumped_f[[0, 2, 3, 4]], rtol=1e-6)
    averaged = [
        mode.natural_frequency
        for mode in modes(lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored"))
    ]
    np.testing.assert_allclose(f.sel(source="lumped averaged"), averaged, rtol=1e-9)


def test_evidence_for_what_is_shared_exists():
    assert len(multibody.SHARED) >= 6
    for item in multibody.SHARED:
        assert item.why
        assert item.evidence
        assert item.where
        for path in item.where:
            assert (ROOT / path).exists(), path
