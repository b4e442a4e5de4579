"""Does the linear form of teeth that differ become that of like teeth where they do not differ?

Like teeth are followed by laws over the path of contact, in steps that end where a law is not smooth; teeth
that differ by the static state of every mesh cycle, in long steps. Both are one motion.
"""

import numpy as np
import pytest

import lumped
from lumped.model.cycle_maps import CycleSteps, linear_steps, stepped_motion
from lumped.model.period_closure import BRAKE_TORQUE, MORE_PINION_TORQUE
from lumped.model.periodic_system import LTVSystem
from lumped.model.powers import mean_powers
from lumped.model.steady import periodic_solution, sample_times
from tests.unlike_pairs import UNLIKE, unlike_pair
from validation.exchange.new_pair_file import new_pair

SAMPLES = 16
#: Pair, contact, supports; the second of ISO stiffness, the third of two to three pairs in contact.
CASES = [
    ("nasa_28_28", "loaded", "springs"),
    ("nasa_28_28", "prescribed", "springs"),
    ("31/57", "loaded", "springs"),
    ("high_contact_ratio_29_47", "loaded", "springs"),
    *((name, contact, "springs") for name in UNLIKE for contact in ("loaded", "prescribed")),
    ("contact_ratio_2_3_on_shafts", "loaded", "shafts"),
    ("contact_ratio_2_3_on_shafts", "prescribed", "shafts"),
]
#: Kind of the deviation of each case: each form of contact has both, and each pair.
FIRST_ORDERS = [("steps", "eccentricity")[(number // 2 + number) % 2] for number in range(len(CASES))]


def pair_of(name, contact):
    if name == "31/57":
        pair = new_pair(name, 3.0, 20.0, 4000.0, 300.0)
    else:
        pair = unlike_pair(name) if name in UNLIKE else lumped.load_gear_pair(name)
    return pair.with_({"mesh.contact": contact}).healthy


def with_deviation(pair, error):
    """The first tooth of the pinion is late by an error [um]."""
    index = [error] + [0.0] * (pair.pinion.teeth - 1)
    return pair.with_({"pinion.deviations": {"index": index, "first_order": "steps"}})


@pytest.mark.parametrize(("name", "contact", "supports"), CASES)
def test_without_deviation_every_quantity_is_that_of_like_teeth(name, contact, supports):
    pair = pair_of(name, contact)
    options = {"samples_per_cycle": SAMPLES, "supports": supports}
    like = lumped.steady_state(pair, **options)
    zero_deviation = lumped.steady_state(with_deviation(pair, 0.0), **options)
    swing = like.attrs["dte_peak_to_peak"]
    force = pair.operating.pinion_torque / pair.geometry.base_radius_pinion

    def largest_change(variable):
        cycles = zero_deviation[variable].values.reshape(-1, SAMPLES)
        return np.abs(cycles - like[variable].values).max()

    for variable in ("dte", "x_p", "x_g", "y_p", "y_g"):
        assert largest_change(variable) < 1e-10 * swing, variable
        peak = f"{variable}_peak_to_peak"
        assert zero_deviation.attrs[peak] == pytest.approx(like.attrs[peak], abs=1e-10 * swing)
    for variable, arm in (
        ("theta_p", pair.geometry.base_radius_pinion),
        ("theta_g", pair.geometry.base_radius_gear),
    ):
        # Both grow with the angle that friction swings.
        assert largest_change(variable) * arm < 1e-9 * swing, variable
    loads = (one["normal_load"].sum("pair").values for one in (zero_deviation, like))
    own_load, like_load = loads
    assert own_load.reshape(-1, SAMPLES) == pytest.approx(
        np.tile(like_load, (own_load.size // SAMPLES, 1)), abs=1e-9 * force
    )
    driving = like.attrs["pinion_torque"] * pair.geometry.omega_pinion
    powers = [key for key in like.attrs if key.startswith("power_")]
    assert set(powers) == {key for key in zero_deviation.attrs if key.startswith("power_")}
    for key in powers:
        assert zero_deviation.attrs[key] == pytest.approx(like.attrs[key], abs=1e-10 * driving, rel=1e-9), key
    for key in ("mesh_efficiency", "brake_torque", "pinion_torque"):
        assert zero_deviation.attrs[key] == pytest.approx(like.attrs[key], rel=1e-10), key


@pytest.mark.parametrize(
    ("name", "contact", "supports", "first_order"),
    [(*case, first_order) for case, first_order in zip(CASES, FIRST_ORDERS, strict=True)],
)
def test_a_femtometre_moves_no_result_by_a_millionth(name, contact, supports, first_order):
    """Every variable and number, linear and unilateral: the type of an input does not choose the model.

    What a deviation moves is of its own size; so small a one, 1e-9 of the transmission error, shows what
    another road to the same number would. Unilateral motions settle to 1e-11 and close to 1e-10.
    """
    pair = pair_of(name, contact)
    index = [1e-9] + [0.0] * (pair.pinion.teeth - 1)
    deviated_pair = pair.with_({"pinion.deviations": {"index": index, "first_order": first_order}})
    for touch in ("linear", "unilateral"):
        options = {"contact": touch, "samples_per_cycle": SAMPLES, "supports": supports}
        like = lumped.steady_state(pair, **options)
        deviated = lumped.steady_state(deviated_pair, **options)
        cycles = deviated.sizes["time"] // like.sizes["time"]
        for variable, values in like.data_vars.items():
            expected = np.concatenate([values.values] * cycles, axis=-1)
            close = 1e-6 * max(np.ptp(expected), 1e-12 * np.abs(expected).max())
            assert deviated[variable].values == pytest.approx(expected, abs=close), (touch, variable)
        for key, value in like.attrs.items():
            # Errors of the methods are their own, and the energy that is left may be rounding.
            if isinstance(value, float) and key not in ("error_estimate", "closure", "power_energy_residual"):
                # 16 outputs do not resolve the fastest vibration: peaks to peak of unilateral motions come
                # from a run with other steps, which differs by the error of the steps.
                share = 1e-5 if touch == "unilateral" and key.endswith("_peak_to_peak") else 2e-6
                assert deviated.attrs[key] == pytest.approx(value, rel=share), (touch, key)


def test_a_picometre_moves_everything_by_about_a_picometre():
    pair = pair_of("nasa_28_28", "loaded")
    deviated, like = (
        lumped.steady_state(with_deviation(pair, error), samples_per_cycle=SAMPLES) for error in (1e-6, 0.0)
    )
    assert 1e-13 < np.abs(deviated.dte.values - like.dte.values).max() < 5e-12


@pytest.mark.parametrize("name", UNLIKE)
def test_long_steps_alone_are_near_the_motion_of_like_teeth(name):
    """Their error, which the motion of teeth that differ leaves out, is small: a wrong weight is not."""
    pair = pair_of(name, "loaded")
    system = LTVSystem.of(pair, "full", supports="springs")
    like = periodic_solution(system, sample_times(system.period, SAMPLES), estimate_error=False)
    steps = CycleSteps(with_deviation(pair, 0.0), system, SAMPLES, linear_steps(system), range(1))
    long = stepped_motion(steps.with_like_teeth())
    dte = [
        states[:, : len(system.coordinates)] @ system.deflection for states in (long.states[0], like.states)
    ]
    assert dte[0] == pytest.approx(dte[1], abs=1e-3 * np.ptp(dte[1]))
    expected = mean_powers(like).by_place
    for place, power in long.powers.items():
        assert power == pytest.approx(expected[place], rel=1e-3, abs=1e-6 * expected["sliding"]), place


@pytest.mark.parametrize("name", UNLIKE)
@pytest.mark.parametrize("contact", ["loaded", "prescribed"])
def test_first_law_of_the_steps_holds_to_rounding_with_eccentric_gears(name, contact):
    changes = {"mesh.contact": contact, "pinion.mounting": {"eccentricity": 3, "phase": 30}}
    changes |= {"gear.deviations": {"tolerance_class": 5, "seed": 3}}
    pair = unlike_pair(name).healthy.with_(changes)
    system = LTVSystem.of(pair.healthy, "full", supports="springs")
    g = pair.geometry
    motion = stepped_motion(CycleSteps(pair, system, 1, linear_steps(system)))
    torque = system.pinion_torque + motion.weights[MORE_PINION_TORQUE]
    brake = motion.weights[BRAKE_TORQUE]
    lost = sum(motion.powers.values()) - 2.0 * motion.powers["rolling"]
    assert torque * g.omega_pinion - brake * g.omega_gear == pytest.approx(lost, rel=1e-9)
