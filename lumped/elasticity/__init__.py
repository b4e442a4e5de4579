"""Plane elasticity of a whole gear by finite elements: how far a load moves its tooth and the next ones.

Derivation and checks: docs/theory/elasticity.md.
"""
