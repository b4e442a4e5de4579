"""Do the guards of validation/validity act just outside their limits, and not just inside? The table is tests/guards."""

from tests.guards import guards_of

test_guard = guards_of("validation/validity")
