"""Faults of single teeth: what each takes from stiffness and flank, one file each, and their registry."""
