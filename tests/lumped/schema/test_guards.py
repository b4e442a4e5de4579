"""Do guards of lumped/schema act just outside their limits, not just inside? Table: tests/guards."""

import pytest

from tests.guards import guards_of
from tests.guards.declared import complaints

test_guard = guards_of("lumped/schema")


@pytest.mark.parametrize("field", complaints())
def test_declared_range(field):
    assert complaints()[field]() == []
