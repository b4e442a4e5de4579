"""Is a shaft divided and coupled as its waves and inertias ask for?"""

import math

import pytest

from lumped.schema.shafts import CoupledInertia, Shaft, ShaftBearing, ShaftSegment
from multibody.shafts.beam import Interval
from multibody.shafts.train import Disc, reduced_shaft


def test_waves_are_those_of_a_slender_beam_at_low_and_of_pure_shear_at_high_frequency():
    """Slender: (E I/(rho A))^(1/4) sqrt(omega) is their speed; shear: sqrt(kappa G/rho), Cowper's kappa."""
    steel = Interval(0.2, 0.03, 0.0, 206e9, 0.3, 7850.0)
    slender = (206e9 * (0.03 / 4.0) ** 2 / 7850.0) ** 0.25  # I/A of a full circle is (d/4)^2
    assert steel.wave_length(2e3) == pytest.approx(2.0 * math.pi * slender / math.sqrt(2e3), rel=1e-12)
    kappa = 6.0 * 1.3 / (7.0 + 6.0 * 0.3)
    rigidity = 206e9 / 2.6
    shear = math.sqrt(kappa * rigidity / 7850.0)
    assert steel.wave_length(1e7) == pytest.approx(2.0 * math.pi * shear / 1e7, rel=1e-12)


def test_a_light_inertia_does_not_stall():
    """On a coupling it would swing at 1e9 Hz."""
    light, heavy = (
        CoupledInertia.model_construct(
            position=0.2, inertia=inertia, coupling_stiffness=1e6, coupling_damping=0.0
        )
        for inertia in (1e-12, 1e-3)
    )
    bearings = tuple(
        ShaftBearing.model_construct(
            position=position, loa_stiffness=3e8, oloa_stiffness=3e8, loa_damping=0.0, oloa_damping=0.0,
            tilt_stiffness=0.0,
        ) for position in (0.0, 0.2)
    )  # fmt: skip
    segment = ShaftSegment.model_construct(length=0.2, diameter=0.03, bore=0.0)
    shaft = Shaft.model_construct(
        segments=(segment,), gear_position=0.1, bearings=bearings, youngs_modulus=206e9, poisson_ratio=0.3,
        density=7850.0,
    )  # fmt: skip
    disc = Disc(0.8, 1.3e-3, 0.9e-3)
    options = {"speed": 0.0, "damping_ratio": 0.0, "highest": 1e5}
    one, two = (reduced_shaft(shaft, disc, motor, **options) for motor in (light, heavy))
    alone = reduced_shaft(shaft, disc, None, **options)
    rotation = 2  # coordinate, after x and y of the gear
    assert one.mass[rotation, rotation] == pytest.approx(alone.mass[rotation, rotation] + 1e-12, rel=1e-12)
    assert two.mass[rotation, rotation] == pytest.approx(alone.mass[rotation, rotation] + 1e-3, rel=1e-9)
    assert one.torque[rotation] == pytest.approx(1.0, rel=1e-9)
    assert two.size == alone.size + 1 == one.size + 1
