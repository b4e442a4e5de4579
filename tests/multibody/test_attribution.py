"""Do the effect switches say why the models differ?"""

from __future__ import annotations

import numpy as np
import pytest

import lumped
from multibody.causes import CAUSES, attribution
from multibody.effects import EFFECTS, active_effects, effect_flags

JUMPS = lumped.load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=0.05)
SMOOTH = JUMPS.with_(mesh__stiffness={"model": "parabolic", "ramp_length": 3.0})


@pytest.mark.slow
def test_causes_of_the_difference():
    """With smooth stiffness the actual sliding velocity is the cause; jumps add the shift of tooth entry.

    Without friction there is no sliding to matter, and every cause that is left is far smaller.
    """
    smooth = attribution(SMOOTH, 5)
    assert smooth.attrs["largest"] == "sliding_velocity"
    dte = smooth["alone"].sel(quantity="dte")
    assert float(dte.sel(cause="sliding_velocity")) == pytest.approx(float(dte.sel(cause="all")), rel=0.1)
    assert float(dte.sel(cause="entry_shift")) < 1e-5
    jumps = attribution(JUMPS, 5)["alone"].sel(quantity="dte")
    assert float(jumps.sel(cause="entry_shift")) > 100 * float(dte.sel(cause="entry_shift"))
    still = attribution(SMOOTH.with_(friction__law="none"), 5)["alone"]
    assert float(still.sel(cause="all", quantity="dte")) < 0.05 * float(dte.sel(cause="all"))
    assert np.isnan(still.sel(cause="all", quantity="y_p"))


def test_every_effect_belongs_to_one_cause():
    assert sorted(name for names in CAUSES.values() for name in names) == sorted(EFFECTS)


def test_flags_name_the_effects():
    for name in EFFECTS:
        assert active_effects(effect_flags({name})) == (name,)
        assert active_effects(effect_flags({name: False})) == tuple(n for n in EFFECTS if n != name)
    assert active_effects(effect_flags(None)) == tuple(EFFECTS)
    assert effect_flags(()) == 0
