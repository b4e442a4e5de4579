"""Stability of the gear pair: charts, tongues, margins, sensitivities."""
