"""Faults put into the running program on purpose, to judge the verdicts: which of them are seen, and by what."""
