"""This pair's solutions against finer ones, its teeth against elasticity; evidence of the program."""

from validation.verification.checks import Check
from validation.verification.solution import Refinement, refinements

__all__ = ["Check", "Refinement", "refinements"]
