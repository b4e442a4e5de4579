"""Verification while you wait: the code against closed forms, the solutions against finer ones."""

from validation.verification.checks import Check, Refinement
from validation.verification.code import code_checks
from validation.verification.solution import refinements

__all__ = [
    "Check",
    "Refinement",
    "code_checks",
    "refinements",
]
