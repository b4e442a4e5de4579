"""Does every public function refuse by name what is no number, no list or no name, before it starts?"""

import inspect
import math

import numpy as np
import pytest

import floquet
import lumped
import multibody
from lumped import friction, losses
from lumped.errors import ParameterError
from lumped.lubrication import film
from lumped.model.averaged import averaged_state_space
from lumped.path_of_contact.friction import friction_profile
from validation import crosscheck

PAIR = lumped.load_gear_pair("nasa_28_28")
SYSTEM = floquet.PeriodicSystem(lambda t: np.array([[0.0, 1.0], [-1.0 - np.cos(t), -0.1]]), 2.0 * np.pi)

#: What no argument of any public function may be, whatever it means: from a form, a file or a slip.
NOTHING = {
    "text": "abc", "empty text": "", "nan": math.nan, "infinite": -math.inf, "imaginary": 1j, "bytes": b"x",
    "too large": 10**400, "no numbers": [None, "x"], "a solid": np.ones((2, 2, 2)),
    "objects": np.array([None, "x"], dtype=object),
}  # fmt: skip
_RUN = "cycles samples_per_cycle initial effects fidelity rtol friction_velocity"
#: Function -> (arguments that it needs besides, arguments that are tried).
CALLS = {
    lumped.simulate: ({"pair": PAIR}, "cycles samples_per_cycle initial as_printed"),
    lumped.steady_state: ({"pair": PAIR}, "samples_per_cycle as_printed"),
    lumped.speed_sweep: ({"pair": PAIR, "speeds_rpm": [4000.0]}, "speeds_rpm samples_per_cycle"),
    lumped.periodic_system: ({"pair": PAIR}, "form as_printed"),
    averaged_state_space: ({"pair": PAIR}, "form"),
    lumped.mesh_stiffness: ({"pair": PAIR}, "samples"),
    lumped.stiffness_components: ({"pair": PAIR}, "points"),
    lumped.plane_compliance: ({"pair": PAIR}, "plane support phases"),
    lumped.static_transmission_error: ({"pair": PAIR}, "torques phases"),
    lumped.optimal_relief: ({"pair": PAIR}, "torque"),
    friction_profile: ({"pair": PAIR}, "points"),
    losses.quasi_static_losses: ({"pair": PAIR}, "law sharing"),
    losses.loss_factor: ({"pair": PAIR}, "sharing"),
    multibody.simulate: ({"pair": PAIR}, _RUN),
    multibody.power_balance: ({"pair": PAIR}, "cycles initial effects fidelity rtol friction_velocity"),
    multibody.steady_state: ({"pair": PAIR, "fidelity": "linear"},
     "samples_per_cycle fidelity effects rtol friction_velocity"),
    multibody.monodromy: ({"pair": PAIR}, "fidelity effects rtol"),
    multibody.speed_sweep: ({"pair": PAIR, "speeds_rpm": [4000.0]},
     "speeds_rpm settle cycles samples_per_cycle fidelity effects rtol"),
    floquet.PeriodicSystem: ({"A": SYSTEM.A, "period": 1.0}, "A period breakpoints"),
    floquet.sampled_matrix: ({"times": [0.0, 0.5, 1.0], "matrices": np.zeros((3, 2, 2)), "period": 1.0},
     "times matrices between"),
    floquet.scan: ({"evaluate": lambda point: SYSTEM, "axes": {"x": [1.0, 2.0]}},
     "axes batched refine store rtol workers"),
    floquet.monodromy: ({"system": SYSTEM}, "rtol method max_substeps"),
    floquet.gear_pair_system: ({"source": PAIR}, "form"),
    floquet.gear_pair_multipliers: ({"source": PAIR}, "rtol method"),
    floquet.stability_chart: ({"pair": PAIR, "axes": {"speed_rpm": [4000.0]}},
     "axes friction_law refine rtol store"),
    floquet.single_degree: ({"pair": PAIR}, "stiffness rtol"),
    floquet.single_degree_chart: ({"pair": PAIR, "axes": {"speed_rpm": [4000.0]}},
     "axes stiffness friction_law refine rtol store"),
    floquet.stability_boundaries: ({"pair": PAIR}, "speed_rpm axes nodes orders xtol rtol"),
    floquet.predicted_lines: ({"pair": PAIR}, "orders"),
    floquet.stability_margins: ({"pair": PAIR}, "speed_rpm"),
    floquet.campbell: ({"pair": PAIR, "speeds_rpm": [4000.0]}, "speeds_rpm mesh_orders orders rtol"),
    floquet.gear_block: ({"source": PAIR}, "rtol"),
    crosscheck: ({"pair": PAIR}, "cycles samples_per_cycle fidelities limit"),
}  # fmt: skip
#: Names that a refusal gives where a pair's own field takes the argument in.
OWN = {
    "friction_law": "friction.law", "law": "friction.law", "name": "axes",
    "thresholds": "friction.thresholds",
}  # fmt: skip


@pytest.mark.parametrize(
    ("function", "argument"),
    [(function, name) for function, (_, names) in CALLS.items() for name in names.split()],
    ids=lambda value: value if isinstance(value, str) else f"{value.__module__}.{value.__name__}",
)
def test_what_can_be_no_argument_is_refused_by_name(within, function, argument):
    for kind, value in NOTHING.items():
        with within(60.0), pytest.raises(ParameterError) as caught:
            function(**CALLS[function][0] | {argument: value})
        first = caught.value.problems[0]
        assert first.field.startswith(OWN.get(argument, argument)), (kind, str(caught.value))
        assert first.allowed
        assert first.action
        assert len(str(caught.value)) < 1500, kind


@pytest.mark.parametrize("value", [v for kind, v in NOTHING.items() if kind != "a solid"], ids=str)
def test_what_is_no_number_is_no_argument_of_a_law(value):
    laws = (
        film.regime, friction.coulomb, friction.smoothed_coulomb, friction.benedict_kelley,
        friction.xu_kahraman, friction.composite,
        losses.iso_14179_mean_coefficient,
    )  # fmt: skip
    for law in laws:
        parameters = inspect.signature(law).parameters.items()
        good = {name: 0.5 for name, parameter in parameters if parameter.default is parameter.empty}
        for name in good:
            with pytest.raises(ParameterError, match=name):
                law(**good | {name: value})
    with pytest.raises(ParameterError, match="maximum"):
        friction.benedict_kelley(100, 10, 2, 10, 0.4, maximum=value)


@pytest.mark.parametrize("argument", ["periods", "damping_factors", "gain_factors", "tolerance"])
def test_malformed_variants_are_refused_by_name(argument):
    block = floquet.gear_block(PAIR)
    for function in (floquet.fast_multipliers, floquet.fast_monodromies):
        for value in NOTHING.values():
            with pytest.raises(ParameterError, match=argument):
                function(block, **{argument: value})
