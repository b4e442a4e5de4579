"""Verification while you wait: the code against closed forms, the solutions against finer ones."""

from validation.verification.checks import Check, OrderCheck, Refinement
from validation.verification.closed_forms import order_checks
from validation.verification.code import code_checks
from validation.verification.solution import refinements

__all__ = [
    "Check",
    "OrderCheck",
    "Refinement",
    "code_checks",
    "order_checks",
    "refinements",
]
