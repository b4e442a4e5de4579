"""Gears on elastic shafts: beam elements, their reduction to modes, and what they give the lumped model."""
