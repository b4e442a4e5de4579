"""Shafts of the multibody model: beams of its own, their reduction, and the machine that they carry."""
