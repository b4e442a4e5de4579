"""Lumped against multibody: differences, tolerances, verdicts."""
