"""Do ISO grades and the viscosity index give the standards' own numbers?"""

import itertools

import pytest

from lumped.errors import ParameterError
from lumped.lubrication.viscosity import (
    ISO_VG_MIDPOINT,
    grade_viscosity,
    reference_oils,
    viscosity_at_100,
    viscosity_index,
)


@pytest.mark.parametrize(
    ("viscosity_40", "viscosity_100", "index"),
    [(73.30, 8.86, 92), (22.83, 5.05, 156), (53.47, 7.80, 111)],  # worked examples of ASTM D2270, section 5
)
def test_viscosity_index_of_the_standards_examples(viscosity_40, viscosity_100, index):
    assert round(viscosity_index(viscosity_40, viscosity_100)) == index


def testreference_oils_of_the_standards_example():
    # ASTM D2270, example of the appendix: Y = 8.86 gives L = 119.9588, H = 69.4765
    low, high = reference_oils(8.86)
    assert low == pytest.approx(119.9588, abs=5e-5)
    assert high == pytest.approx(69.4765, abs=5e-5)


def test_pieces_of_thereference_oils_join():
    # a wrong digit in the table shows as a gap; each piece is within 0.1 per cent of the tabulated oils
    for joint in (3.8, 4.4, 5.0, 6.4, 7.0, 7.7, 9.0, 12.0, 15.0, 18.0, 22.0, 28.0, 40.0, 55.0, 70.0):
        for left, right in zip(reference_oils(joint), reference_oils(joint * (1 + 1e-12)), strict=True):
            assert left == pytest.approx(right, rel=2e-3)


@pytest.mark.parametrize("viscosity", [10.0, 46.0, 100.0, 320.0, 3200.0])
@pytest.mark.parametrize("index", [60.0, 95.0, 100.0, 140.0])
def test_viscosity_at_100_inverts_the_index(viscosity, index):
    assert viscosity_index(viscosity, viscosity_at_100(viscosity, index)) == pytest.approx(index, abs=0.5)


def test_grades_are_a_preferred_number_series():
    # ISO 3448: each mid-point about 50 per cent above the one before
    grades = list(ISO_VG_MIDPOINT)
    assert (len(grades), grades[0], grades[-1]) == (20, 2, 3200)
    for grade, following in itertools.pairwise(grades):
        assert 1.4 <= ISO_VG_MIDPOINT[following] / ISO_VG_MIDPOINT[grade] <= 1.55


def test_grade_is_its_midpoint_at_40_and_thins_with_temperature():
    assert grade_viscosity(220, 40.0) == pytest.approx(220.0, rel=1e-12)
    hot = grade_viscosity(220, [40.0, 60.0, 80.0, 100.0])
    assert (hot[1:] < hot[:-1]).all()


def test_a_higher_index_stays_thicker_when_hot():
    assert grade_viscosity(100, 100.0, index=140) > grade_viscosity(100, 100.0, index=95)


def test_what_does_not_exist_is_refused():
    with pytest.raises(ParameterError, match="iso_vg = 50: allowed 2, 3, 5"):
        grade_viscosity(50, 60.0)
    with pytest.raises(ParameterError, match="viscosity_index"):
        viscosity_at_100(2.2)
    with pytest.raises(ParameterError, match="kinematic_viscosity_100"):
        viscosity_index(10.0, 1.5)
