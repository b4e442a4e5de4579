"""Faults put into the running program on purpose, to judge the verdicts: which are seen, and by what."""
