"""Does every criterion decide where its words say, and does a claim state the numbers that its words name?"""

import pytest

from lumped.friction.xu_kahraman import xu_kahraman
from reproductions.he_cho_singh_2008.claims.judge import ACCURACY
from reproductions.he_cho_singh_2008.claims.rules import RULES

#: Numbers that meet every criterion, well inside.
MET = {
    "mean_ratio": 5.0,
    "iii_at_pitch": 0.1,
    "ii_at_pitch": 1.5,
    "switch_width": 0.1,
    "switch_drop": 2.0,
    "switch_speed": 2500.0,
    "jump_coulomb": 1.0,
    "jump_benedict_kelley": 1.0,
    "jump_xu_kahraman": 0.0,
    "jump_smoothed_coulomb": 0.0,
    "load_spread": 0.01,
    "rms_x_p": 0.01,
    "rms_dte": 0.01,
    "rms_y_p": 0.01,
    "order_y_p": 2.0,
    "mean_absolute_x_p": 0.08,
    "mean_absolute_y_p": 0.08,
    "mean_iii_slow": 0.004,
}
#: Claim, number, last value that meets the criterion as it is written, first that does not.
EDGES = [
    ("mean of II above III", "mean_ratio", 2.0, 1.99),
    ("pitch point", "iii_at_pitch", 0.2, 0.201),
    ("pitch point", "ii_at_pitch", 1.001, 1.0),
    ("abrupt regime change", "switch_width", 0.2, 0.201),
    ("abrupt regime change", "switch_drop", 1.2, 1.199),
    ("speed of the regime change", "switch_speed", 2000.0, 1999.0),
    ("speed of the regime change", "switch_speed", 3000.0, 3001.0),
    ("jumps", "jump_coulomb", 0.5, 0.499),
    ("jumps", "jump_benedict_kelley", 0.5, 0.499),
    ("jumps", "jump_xu_kahraman", 0.01, 0.0101),
    ("jumps", "jump_smoothed_coulomb", -0.01, -0.0101),
    ("normal load", "load_spread", 0.05, 0.0501),
    ("LOA motion and DTE", "rms_x_p", 0.05, 0.0501),
    ("LOA motion and DTE", "rms_dte", 0.05, 0.0501),
    ("OLOA motion", "rms_y_p", 0.05, 0.0501),
    ("second harmonic", "order_y_p", 2.0, 1.0),
    ("second harmonic", "order_y_p", 2.0, 3.0),
    ("8 % discrepancy", "mean_absolute_x_p", 0.04, 0.039),  # with y 0.08: 6 % in the mean
    ("8 % discrepancy", "mean_absolute_y_p", 0.12, 0.121),
    ("identified mu", "mean_iii_slow", 0.003, 0.0029),
    ("identified mu", "mean_iii_slow", 0.005, 0.0051),
]


@pytest.mark.parametrize(("name", "key", "inside", "outside"), EDGES)
def test_a_criterion_decides_where_its_words_say(name, key, inside, outside):
    rule = next(rule for rule in RULES if rule.name == name)
    assert rule.holds({**MET, key: inside})
    assert not rule.holds({**MET, key: outside})


def test_every_criterion_has_its_edges_pinned():
    # The 3 % claim has no number of its own: it is met where the prediction stays within 3 %.
    assert {edge[0] for edge in EDGES} == {rule.name for rule in RULES} - {ACCURACY}


#: Made-up numbers, all different, and what each claim states with them: value, then its further numbers.
DIFFERENT = {
    **MET,
    "switch_drop": 2.8,
    "jump_benedict_kelley": 0.9,
    "jump_xu_kahraman": 0.001,
    "jump_smoothed_coulomb": 0.002,
    "load_spread": 0.036,
    "load_spread_rms": 0.019,
    "rms_x_p": 0.029,
    "rms_dte": 0.016,
    "rms_y_p": 0.385,
    "order_x_p": 3.0,
    "order_dte": 4.0,
    "relative_order_y_p": 5.0,
    "relative_order_x_p": 6.0,
    "relative_order_dte": 7.0,
    "mean_absolute_x_p": 0.013,
    "mean_absolute_y_p": 0.163,
    "mean_iii_fast": 0.003,
    "peak_normal": 2628.0,
    "peak_friction": 33.0,
}
#: Law III with R in millimetres over that in metres, at its check value.
_MM_FOR_M = float(xu_kahraman(1.0, 0.1, 10.0, 10.0, 0.3, 8.0) / xu_kahraman(1.0, 0.1, 10.0, 10.0, 0.3, 8e-3))
STATED = {
    "mean of II above III": [5.0],
    "pitch point": [0.1, 1.5],
    "abrupt regime change": [10.0, 2.8],
    "speed of the regime change": [2500.0],
    "jumps": [0.9, 0.001, 0.002],
    "normal load": [3.6, 1.9],
    "LOA motion and DTE": [2.9, 2.9, 1.6],
    "OLOA motion": [38.5],
    "second harmonic": [2.0, 3.0, 4.0, 5.0, 6.0, 7.0],
    "8 % discrepancy": [8.8, 1.3, 16.3],
    "identified mu": [0.004, 0.003, 0.004 * _MM_FOR_M],
    "3 % error": [33.0, 2628.0],
}


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.name)
def test_a_claim_states_the_numbers_that_its_words_name(rule):
    found = [rule.value(DIFFERENT), *(one.value for one in rule.further(DIFFERENT).values())]
    assert found == pytest.approx(STATED[rule.name], rel=1e-6)
