"""Do guards of lumped/lubrication act just outside their limits, not just inside? Table: tests/guards."""

from tests.guards import guards_of

test_guard = guards_of("lumped/lubrication")
