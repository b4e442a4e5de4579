"""Stiffness of the teeth by formulas of this package: second values beside the stiffness of ``lumped``."""
