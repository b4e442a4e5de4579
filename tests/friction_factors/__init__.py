"""A factor on mu for tests, and for each factor of the program a value that acts.

The factor of the tests is a hundredth of the viscosity index of an oil that is given by two viscosities. No
number depends on that field, so that two pairs with other indices differ by the factor alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NamedTuple

import pytest

from lumped import GearPair
from lumped.schema import friction as schema
from lumped.schema.contact import Lubricant
from lumped.schema.friction import Friction, FrictionFactor
from lumped.schema.gear import Gear
from multibody.contact import friction as multibody_friction

#: Oil given by two viscosities.
OIL = {
    "lubricant.viscosity": None,
    "lubricant.viscosity_law": {
        "kinematic_viscosity_40": 68.0, "kinematic_viscosity_100": 8.7, "density": 880.0, "temperature": 71.0,
    },
}  # fmt: skip


class Acting(NamedTuple):
    """Changes of a pair that decide a factor, and this factor, computed by hand; it is far from 1."""

    changes: Mapping[str, Any]
    factor: float


#: First field that a factor reads -> `Acting`: one entry for each factor of `lumped.schema.friction.FACTORS`.
ACTING: Mapping[str, Acting] = {}


def _index(gears: tuple[Gear, Gear], lubricant: Lubricant, friction: Friction) -> float:
    law = lubricant.viscosity_law
    return 1.0 if law is None or law.iso_vg is not None else law.viscosity_index / 100.0


EXAMPLE = FrictionFactor(_index, ("lubricant.viscosity_law.viscosity_index",))


def with_factor(pair: GearPair, factor: float, **changes: Any) -> GearPair:
    """Return the pair in one oil, with a factor on mu in `example_factor`."""
    index = {"lubricant.viscosity_law.viscosity_index": 100.0 * factor}
    return pair.with_(OIL | changes).with_(index)


@contextmanager
def example_factor(*, in_multibody: bool = True) -> Iterator[None]:
    """Both models, or the lumped one alone, have the factor of the tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(schema, "FACTORS", (*schema.FACTORS, EXAMPLE))
        if in_multibody:
            before = multibody_friction._factor_on_mu
            patch.setattr(
                multibody_friction, "_factor_on_mu",
                lambda pair: before(pair) * _index((pair.pinion, pair.gear), pair.lubricant, pair.friction),
            )  # fmt: skip
        yield
