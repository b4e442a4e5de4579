"""Are the losses of both models compared, and is a wrong one in either model seen?"""

import dataclasses

import pytest

from lumped.gear_geometry.geometry import build_geometry
from tests.unlike_pairs import unlike_pair
from tests.validation.cross_check.checked import checked
from validation.cross_check.comparison import crosscheck
from validation.cross_check.losses import LOSS_LIMIT, LossAgreement
from validation.cross_check.verdict import Verdict
from validation.cross_check.words import loss_difference


@pytest.mark.parametrize("name", ["heavily_relieved_under_load", "larger_gear_drives_contact_lost"])
def test_both_models_lose_the_same_power_at_the_same_places(name):
    """Finite motions leave less than 1 % of the whole, and a tenth of each part."""
    loss = checked(name).loss
    assert loss.within
    assert loss.difference < 0.01
    assert set(loss.lumped) == set(loss.multibody) == {"sliding", "tooth_dampers", "bearings"}
    for place, lost in loss.lumped.items():
        assert loss.multibody[place] == pytest.approx(lost, rel=0.1), place


def test_teeth_that_differ_are_compared_by_what_sliding_takes():
    """Over all 60 cycles after which the same teeth meet again; finite motions leave 1.0 %."""
    loss = checked("unlike_teeth_finite_elements").loss
    assert set(loss.lumped) == {"sliding"}
    assert loss.difference < 0.012


def test_a_wrong_speed_of_the_gear_in_the_lumped_model_is_seen(monkeypatch):
    """omega_g times 1.24 moves no force: motions still agree, but sliding and its loss are 11 % too large."""
    right = checked("contact_ratio_2_3_on_shafts")
    assert right.verdict is Verdict.AGREES

    def too_fast(*arguments):
        g = build_geometry(*arguments)
        return dataclasses.replace(g, omega_gear=1.24 * g.omega_gear)

    monkeypatch.setattr("lumped.schema.pair.build_geometry", too_fast)
    pair = unlike_pair("contact_ratio_2_3_on_shafts").with_(torque=209.999)  # nothing is kept of it
    wrong = crosscheck(pair, cycles=6, variant=False, supports="springs")
    assert not wrong.loss.within
    assert wrong.verdict is not Verdict.AGREES


def test_a_difference_of_the_losses_alone_is_the_verdict_and_is_said():
    check = checked("contact_ratio_2_3_on_shafts")
    more = {place: 1.06 * lost for place, lost in check.loss.lumped.items()}
    differing = dataclasses.replace(check, loss=LossAgreement(check.loss.lumped, more))
    assert differing.loss.difference == pytest.approx(0.06, rel=1e-12)
    assert (differing.loss.limit, differing.loss.within, differing.verdict) == (
        LOSS_LIMIT,
        False,
        Verdict.DIFFERS,
    )
    text = loss_difference(differing).replace("\N{NO-BREAK SPACE}", " ")
    assert "199 W beside 188 W, which does not agree: 6 %, limit 5 %" in text


def test_without_losses_both_models_agree_and_a_loss_in_one_alone_does_not():
    assert LossAgreement({"sliding": 0.0}, {"sliding": 0.0}).within
    assert not LossAgreement({"sliding": 0.0}, {"sliding": 1e-9}).within
