"""Floquet theory of any linear system with periodic coefficients; knows no gears."""
