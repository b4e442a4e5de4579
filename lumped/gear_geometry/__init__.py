"""The gears at rest: circles, line of action, tooth outline; numbers in, no schema."""
