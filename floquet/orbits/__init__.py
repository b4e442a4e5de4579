"""Periodic motions of systems that are linear between events. No code about gears."""
