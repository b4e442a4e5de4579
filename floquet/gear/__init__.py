"""Stability of the gear pair: multipliers, charts, tongues, motions with contact loss."""
