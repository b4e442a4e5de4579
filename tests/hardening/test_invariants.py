"""Do facts that hold for every gear pair hold for pairs drawn at random?"""

import math
import warnings

import numpy as np
import pytest
from hypothesis import event, given
from hypothesis import strategies as st

from floquet.gear.multipliers import gear_pair_multipliers
from lumped import load_gear_pair, steady_state
from lumped.errors import LawRangeWarning, ParameterError, SpurcheckError
from lumped.fields.units import UNITS, to_si
from lumped.schema.pair import leaf_paths, stated_unit


def quiet(function, *arguments, **options):
    """Return the result of a computation without warnings of the friction law. None: the input is refused."""
    name = function.__name__
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)
        try:
            result = function(*arguments, **options)
        except SpurcheckError as error:
            event(f"{name} refused: {type(error).__name__}")
            return None
    event(f"{name} answered")
    return result


@given(data=st.data())
def test_friction_takes_power_and_efficiency_stays_below_1(pairs, data):
    pair = data.draw(pairs)
    run = quiet(steady_state, pair, samples_per_cycle=64)
    if run is None:
        return
    power = run["friction_power_nominal"].to_numpy()
    load = run["normal_load"].to_numpy()
    pressed = load >= 0.0
    # -mu N v with mu of the sign of v: not positive while the teeth press, up to the sign of a rounded zero.
    assert (power[pressed] <= 0.0).all()
    assert (power[~pressed] >= 0.0).all()
    if pressed.all():
        # The balance of powers is solved to the closure of the periodic motion.
        assert run.attrs["mesh_efficiency"] <= 1.0 + 1e-9
    for name in run.data_vars:
        assert np.isfinite(run[name].to_numpy()).all(), name


@given(data=st.data())
def test_multipliers_come_in_conjugate_pairs_and_det_is_liouvilles(pairs, data):
    pair = data.draw(pairs)
    found = quiet(gear_pair_multipliers, pair)
    if found is None:
        return
    values = found.multipliers
    errors = found.multiplier_errors
    for value, error in zip(values, errors, strict=True):
        distance = np.abs(values - value.conjugate())
        # Each conjugate is there to within the errors that the analysis itself states.
        assert (distance <= error + errors + 1e-14).any()
    # Every multiplier lies in its disk, so the determinant is known to the product of what they can reach;
    # the integral of tr A is right to a few roundings of itself.
    sizes = np.abs(values)
    trace = math.log(np.prod(np.abs(found.feedback)) + 1e-300)
    known = np.prod(sizes + errors) - np.prod(sizes) + 1e-13 * (1.0 - trace) * np.prod(sizes)
    residual = quiet(lambda: found.liouville_residual)
    assert residual * np.prod(np.abs(found.oloa)) <= known + 1e-300


#: SI unit -> exponents of length, time and force (a mass is force time^2 / length).
EXPONENTS = {
    "1": (0, 0, 0), "rad": (0, 0, 0), "m": (1, 0, 0), "1/m": (-1, 0, 0), "rad/s": (0, -1, 0),
    "N*m": (1, 0, 1), "kg": (-1, 2, 1), "kg*m**2": (1, 2, 1), "kg/m**3": (-4, 2, 1), "Pa": (-2, 0, 1),
    "N/m": (-1, 0, 1), "Pa*s": (-2, 1, 1), "m/s": (1, -1, 0),
}  # fmt: skip
#: Variable -> exponents of its result.
RESULTS = {
    "theta_p": (0, 0, 0), "x_p": (1, 0, 0), "y_g": (1, 0, 0), "dte": (1, 0, 0), "dte_dot": (1, -1, 0),
    "normal_load": (0, 0, 1), "friction_power": (1, -1, 1), "mesh_stiffness": (-1, 0, 1),
    "bearing_force_x_p": (0, 0, 1),
}  # fmt: skip


def factor(exponents, scales):
    return float(np.prod([scale**power for scale, power in zip(scales, exponents, strict=True)]))


def scaled(pair, scales):
    """Return the pair in other units: every quantity is multiplied by the factor of the dimension."""
    changes = {}
    for path, value in leaf_paths(pair).items():
        unit = stated_unit(path)
        if unit is None or value == "balanced":
            continue
        si = UNITS[unit].si
        if any(EXPONENTS[si]):
            changes[path] = f"{to_si(value, unit) * factor(EXPONENTS[si], scales)!r} {si}"
    return pair.with_(changes)


@pytest.fixture(scope="module")
def similar():
    """Return a pair without empirical laws, because these laws have fixed units. The inertia is stated."""
    return load_gear_pair("nasa_28_28").with_(
        friction__law="smoothed_coulomb",
        friction__coefficient=0.06,
        mesh__stiffness={"model": "parabolic", "peak": 2.5e8, "end_ratio": 0.6, "ramp_length": 0.4},
    )


# Powers of two up to 2^6 each way keep decimal numbers short and the scaled pair inside the schema's ranges.
@given(powers=st.tuples(*[st.integers(-2, 2)] * 3))
def test_results_scale_with_length_time_and_force(similar, powers):
    scales = tuple(2.0**power for power in powers)
    try:
        other = scaled(similar, scales)
    except ParameterError:  # such as a Young's modulus that the schema does not believe
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)
        base, run = (steady_state(pair, samples_per_cycle=32) for pair in (similar, other))
        multipliers = [gear_pair_multipliers(pair) for pair in (similar, other)]
    # Both runs carry the stated error of the periodic solution, of order 1e-8, and nothing else.
    tolerance = 10.0 * (base.attrs["error_estimate"] + run.attrs["error_estimate"]) + 1e-9
    for name, exponents in RESULTS.items():
        expected = base[name].to_numpy() * factor(exponents, scales)
        np.testing.assert_allclose(
            run[name], expected, rtol=0, atol=tolerance * np.abs(expected).max(), err_msg=name
        )
    assert run.attrs["mesh_efficiency"] == pytest.approx(base.attrs["mesh_efficiency"], abs=tolerance)
    assert multipliers[1].spectral_radius == pytest.approx(
        multipliers[0].spectral_radius, abs=multipliers[0].error + multipliers[1].error + 1e-12
    )
