"""Figures: functions from a result to a matplotlib Figure, without global state, one file a subject."""
