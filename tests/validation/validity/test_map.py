"""Does the validity map say at every point what the flags say at an operating point?"""

import numpy as np
import pytest
from validation.plots.validity_map import validity_map_figure

import lumped
from floquet.gear.multipliers import gear_pair_multipliers
from validation.validity.flags import contact_loss, film_regime, sliding_reversal
from validation.validity.map import STATES, validity_map, validity_state


def test_contact_is_lost_by_speed_alone_and_the_film_thins_with_torque(pair):
    # Without errors of the teeth the equations are linear in the load, so loads over the static load do not
    # depend on torque; law III makes friction, a small part, depend on it: a few percent.
    data = validity_map(pair, [4875.0, 16500.0], [20.0, 80.0])
    lowest = data["lowest_load"].to_numpy()
    np.testing.assert_allclose(lowest[0], lowest[1], atol=0.05)
    assert lowest[0, 1] < 0 < lowest[0, 0]
    assert data["state"].to_numpy().tolist() == [[0, 2], [0, 2]]
    film = data["film_parameter"].to_numpy()
    assert (film[1] < film[0]).all()  # more load, thinner film
    assert (film[:, 1] > film[:, 0]).all()  # more speed, thicker film
    assert STATES[0] == "valid"
    # The map's film is the thinnest of the path, the one that the flag at an operating point reports; 65
    # against 201 places on a smooth curve.
    at = pair.with_({"operating.pinion_speed": 4875.0, "operating.pinion_torque": 80.0})
    assert film[1, 0] == pytest.approx(film_regime(at).value, rel=1e-3)


def test_an_unstable_point_of_the_map_is_not_valid(pair):
    state = validity_state(np.ones(3), np.zeros(3), np.array([0.9, 1.1, 1.0]))
    assert state.tolist() == [0, 2, 0]
    # The widest tongue of the undamped pair; its largest multiplier at 17000 rpm is known to Floquet.
    undamped = pair.with_({"mesh.damping_ratio": 0.0})
    data = validity_map(undamped, [4875.0, 17000.0], [20.0, 56.5])
    expected = gear_pair_multipliers(undamped.with_({"operating.pinion_speed": 17000.0})).spectral_radius
    radius = data["spectral_radius"].to_numpy()
    assert radius[1, 1] == pytest.approx(expected, rel=1e-6)
    assert (radius[:, 0] < 1.0).all()
    crosses = [line for line in validity_map_figure(data).axes[0].lines if line.get_marker() == "x"]
    assert [line.get_xdata().tolist() for line in crosses] == [[17000.0, 17000.0]]


def test_the_map_is_the_flag_of_each_point(pair):
    # The map goes by sweeps over speed; each point must be what its own periodic motion says.
    data = validity_map(pair, [900.0, 4875.0], [20.0, 150.0])
    for row, torque in enumerate((20.0, 150.0)):
        for column, rpm in enumerate((900.0, 4875.0)):
            at = pair.with_({"operating.pinion_speed": rpm, "operating.pinion_torque": torque})
            g, motion = lumped.geometry(at), lumped.steady_state(at, samples_per_cycle=96)
            lowest = contact_loss(at, g, motion).value * g.base_radius_pinion / torque
            reversal = sliding_reversal(g, motion).value / g.base_pitch
            point = data.isel(torque=row, speed=column)
            assert float(point["lowest_load"]) == pytest.approx(lowest, rel=1e-9)
            assert float(point["reversal"]) == pytest.approx(reversal, rel=1e-9)
    assert float(data["reversal"].max()) > 0.0


def test_slow_and_heavy_running_reverses_the_sliding(pair):
    data = validity_map(pair, [300.0], [10.0, 300.0])
    reversal = data["reversal"].to_numpy()[:, 0]
    # Elastic velocities grow with torque, sliding at a given place does not.
    assert reversal[1] > reversal[0]
    assert data["state"].to_numpy()[1, 0] > 0
