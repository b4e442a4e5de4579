"""Do guards of lumped/schema act just outside their limits, not just inside? Table: tests/guards."""

import pytest

from tests.guards import declared_fields, guards_of

test_guard = guards_of("lumped/schema")


@pytest.mark.parametrize("complaints", declared_fields().values(), ids=declared_fields())
def test_declared_range(complaints):
    assert complaints() == []
