"""Reproduction of the paper: figures 2 to 7, claims with verdicts, errata by computation."""
