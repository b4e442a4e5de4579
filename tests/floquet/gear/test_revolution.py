"""Multipliers over a revolution: those of like teeth to its power, moved by a crack as by its softer pair."""

import numpy as np
import pytest

import floquet
import lumped

PAIR = lumped.load_gear_pair("nasa_28_28").with_(
    {"operating.pinion_speed": 1500, "friction.law": "coulomb", "friction.coefficient": 0.06}
)
LIKE = {"index": [0.0] * 28, "first_order": "steps"}


@pytest.mark.parametrize("contact", ["prescribed", "loaded"])
def test_like_teeth_have_the_multipliers_of_the_mesh_cycle_to_the_28th_power(contact):
    pair = PAIR.with_({"mesh.contact": contact, "mesh.relief": "ignored"})
    expected = floquet.gear_pair_multipliers(pair).feedback
    found = floquet.revolution_multipliers(pair.with_({"pinion.deviations": LIKE}))
    assert found.cycles == 28
    assert abs(found.rate - abs(expected[0])) <= found.error + 1e-9
    assert found.error < 1e-4
    assert found.rate == pytest.approx(found.healthy_rate, rel=1e-12)
    power = expected[:2] ** 28
    assert np.sort_complex(found.multipliers[:2]) == pytest.approx(np.sort_complex(power), rel=5e-3)
    assert found.stable


def test_the_longest_hunting_period_neither_overflows_nor_underflows():
    changes = {"pinion.teeth": 19, "gear.teeth": 41, "centre_distance": None, "mesh.contact": "prescribed"}
    changes |= {"pinion.tip_relief": None, "gear.tip_relief": None, "friction.coefficient": 0.0}
    both = {f"{gear}.deviations": {"tolerance_class": 6} for gear in ("pinion", "gear")}
    found = floquet.revolution_multipliers(PAIR.with_(changes | both), steps=320)
    assert found.cycles == 779
    assert np.abs(found.multipliers).max() < 1e-100
    assert found.rate == pytest.approx(found.healthy_rate, rel=1e-7)  # eccentric gears have moments


def test_a_softer_tooth_moves_the_rate_by_its_share_of_the_pairs():
    # To first order a change of one cycle in 28 moves the logarithm by 1/28 of what it does in every cycle.
    pair = PAIR.with_({"mesh.contact": "prescribed", "mesh.relief": "ignored"})

    def moved(*teeth):
        faults = [{"kind": "crack", "tooth": tooth, "depth": 1.0} for tooth in teeth]
        found = floquet.revolution_multipliers(pair.with_({"pinion.faults": faults}))
        return np.log(found.rate / found.healthy_rate)

    one, every = moved(3), moved(*range(1, 29))
    assert abs(every) > 1e-4
    assert 28.0 * one == pytest.approx(every, rel=0.25)
