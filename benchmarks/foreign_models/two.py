"""Records with two mistakes that have nothing to do with each other."""

from __future__ import annotations

from benchmarks.foreign_models.wrong import Wrong

TWO: list[Wrong] = []
