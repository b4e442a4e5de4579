"""Machines of the table [posterior]: one input that takes whole rows, and errors of results by the model."""

import numpy as np
import pytest

from lumped import load_gear_pair
from lumped.errors import ParameterError
from validation.prediction.inputs import uncertain_inputs
from validation.prediction.machines import with_errors

BASE = load_gear_pair("nasa_28_28").with_(
    {"assumed": {}, "mesh.damping_ratio": 0.05, "pinion.tip_alteration": 0.0, "gear.tip_alteration": 0.0}
)
FACTORS = [1.0, 0.9, 0.95, 1.0, 1.05, 1.1, 1.15, 1.2]
DAMPING = [0.05, 0.11, 0.12, 0.13, 0.14, 0.15, 0.16, 0.17]


def _pair(**columns):
    table = {"mesh.stiffness_factor": FACTORS, "mesh.damping_ratio": DAMPING} | columns
    return BASE.with_({"posterior": table, "mesh.stiffness_factor": 1.0})


def test_a_row_is_taken_as_a_whole():
    (records,) = uncertain_inputs(_pair())
    for place in range(7):  # the first machine is the pair as given
        changes = records.changes((place + 0.5) / 7.0)
        assert changes == {
            "mesh.stiffness_factor": FACTORS[1 + place],
            "mesh.damping_ratio": DAMPING[1 + place],
        }
    assert records.changes(1.0)["mesh.stiffness_factor"] == 1.2


def test_a_changed_field_leaves_the_rows():
    (records,) = uncertain_inputs(_pair().with_({"mesh.damping_ratio": 0.04}))
    assert records.changes(0.0) == {"mesh.stiffness_factor": 0.9}
    assert [one.field for one in uncertain_inputs(_pair().with_({"mesh.stiffness_factor": 1.01}))] == [
        "records"
    ]


def test_a_stated_range_of_a_fitted_field_does_not_vary_it_twice():
    pair = _pair().with_({"uncertainty": {"mesh.damping_ratio": "+- 10 %", "mesh.backlash": "+- 10 %"}})
    assert [one.field for one in uncertain_inputs(pair)] == ["records", "mesh.backlash"]


def test_errors_of_the_model():
    numbers = {
        "dte_peak_to_peak": 4e-6, "dynamic_factor": 1.5, "tooth_load": 1.2, "least_force": 0.6,
        "bearing_rms": 100.0, "efficiency": 0.99,
    }  # fmt: skip
    errors = {"dte_peak_to_peak": 0.1, "dynamic_factor": 0.2, "bearing_rms": -0.5}
    found = with_errors(numbers, errors)
    # 1 + 0.5 x 1.2 = 1.6; 1.2 x 1.6/1.5 = 1.28; 1 - 0.4 x 1.2 = 0.52.
    expected = [4.4e-6, 1.6, 1.28, 0.52, 50.0, 0.99]
    assert list(found.values()) == pytest.approx(expected)
    assert with_errors(numbers, {}) == numbers


def test_errors_belong_to_their_machine():
    error = [0.0, *np.linspace(-0.3, 0.3, 7)]
    (records,) = uncertain_inputs(_pair(**{"error.dte_peak_to_peak": error}))
    assert records.errors_at(0.0) == {"dte_peak_to_peak": -0.3}
    assert records.errors_at(0.999) == {"dte_peak_to_peak": 0.3}


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({"mesh.damping_ratio": DAMPING[:-1]}, "lists of one length"),
        ({"mesh.damping": DAMPING}, "Did you mean 'damping_ratio'"),
        ({"mesh.damping_ratio": [*DAMPING[:-1], float("nan")]}, "finite"),
        ({"mesh.damping_ratio": [*DAMPING[:-1], "much"]}, "names only"),
        ({"error.noise": DAMPING}, "error.dte_peak_to_peak"),
    ],
)
def test_a_damaged_table_is_refused(columns, words):
    with pytest.raises(ParameterError, match=words):
        uncertain_inputs(_pair(**columns))


def test_too_few_machines_are_refused():
    with pytest.raises(ParameterError, match="8 to 1024"):
        BASE.with_({"posterior": {"mesh.damping_ratio": DAMPING[:7]}})
    assert BASE.with_({"posterior": {"mesh.damping_ratio": DAMPING}}).posterior
    many = [0.05] * 1024
    assert BASE.with_({"posterior": {"mesh.damping_ratio": many}}).posterior
    with pytest.raises(ParameterError, match="8 to 1024"):
        BASE.with_({"posterior": {"mesh.damping_ratio": [*many, 0.05]}})


def test_the_table_survives_the_file():
    pair = _pair(**{"error.dte_peak_to_peak": [0.1 * one for one in DAMPING]})
    import tomllib

    assert load_gear_pair(tomllib.loads(pair.to_toml())) == pair
