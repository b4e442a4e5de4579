"""Cross-checks that several tests read."""

from functools import cache

from tests.unlike_pairs import unlike_pair
from validation.cross_check.comparison import CrossCheck, crosscheck


@cache
def checked(name: str) -> CrossCheck:
    """The cross-check of one of the unlike pairs, without the variant. Tests must not change the result."""
    return crosscheck(unlike_pair(name), cycles=6, samples_per_cycle=64, variant=False, supports="springs")
