"""Do gears whose teeth differ move in the multibody model as in the lumped one, and keep the first law?"""

import numpy as np
import pytest

import lumped
import multibody
from lumped.teeth.motion import push_motion

CYCLES, SAMPLES = 14, 16
ERRORS = [round(1.5 * np.sin(2.1 * j) + 0.9 * np.cos(5.3 * j), 3) for j in range(28)]
OWN = {
    "pinion.deviations": {"index": ERRORS, "first_order": "steps"},
    "gear.deviations": {"index": ERRORS[::-1], "first_order": "steps"},
    "pinion.mounting": {"eccentricity": 4, "phase": 70},
    "gear.mounting": {"eccentricity": 6},
}


@pytest.fixture(scope="module")
def pair():
    """A quarter of the torque, for what finite motion changes falls with its square."""
    changes = {"mesh.contact": "loaded", "mesh.relief": "ignored", "operating.pinion_torque": 14.0}
    changes |= {"operating.pinion_speed": 1450, "friction.law": "coulomb", "friction.coefficient": 0.0}
    return lumped.load_gear_pair("nasa_28_28").with_(changes)


@pytest.fixture(scope="module")
def both(pair):
    """Function: DTE over the last 8 cycles of multibody and lumped model, in um."""

    def of(changes):
        own = pair.with_(changes)
        run = multibody.simulate(own, CYCLES, initial="periodic", samples_per_cycle=SAMPLES)
        lump = push_motion(own, SAMPLES)
        dte = lump.states[:, :6] @ lump.system.structure.deflection
        part = slice(6 * SAMPLES, CYCLES * SAMPLES)
        return run.dte.values[part] * 1e6, dte[part] * 1e6

    return of


@pytest.mark.parametrize(
    "changes", [OWN, {**OWN, "mesh.first_teeth": [5, 24]}], ids=["first teeth 1, 1", "first teeth 5, 24"]
)
def test_both_models_move_alike(both, changes):
    exact, lump = both(changes)
    # Finite rotations alone make 3 per cent of the swing here; another tooth or sign would make 30.
    assert np.abs(exact - lump).max() < 0.03 * np.ptp(lump)


def test_other_teeth_would_be_seen(both):
    exact, lump = both(OWN)
    other = both({**OWN, "mesh.first_teeth": [2, 1]})[1]
    assert np.abs(exact - other).max() > 0.1 * np.ptp(lump)


def test_first_law_holds_with_own_gaps_and_eccentric_base_circles(pair):
    balance = multibody.power_balance(
        pair.with_(OWN | {"gear.mounting": {"eccentricity": 40}, "friction.coefficient": 0.05}),
        cycles=4,
        initial="periodic",
    )
    assert abs(balance.residual) < 1e-8 * balance.driving


@pytest.mark.parametrize(("changes", "field"), [
    ({"pinion.faults": [{"kind": "crack", "tooth": 1, "depth": 1}]}, "pinion.faults"),
    ({"gear.deviations": {"profile_slope": [1.0] * 28}}, "gear.deviations.profile_slope"),
    ({"operating.torque_ripple": [{"shaft": "gear", "order": 1, "amplitude": 1}]}, "torque_ripple"),
])  # fmt: skip
def test_what_it_does_not_have_is_refused(pair, changes, field):
    with pytest.raises(lumped.ParameterError, match=field):
        multibody.simulate(pair.with_(changes), 1)
    with pytest.raises(lumped.ParameterError, match="fidelity"):
        multibody.simulate(pair.with_(OWN), 1, fidelity="linear")
