"""Teeth that differ: which pairs meet, their gaps, statics and motion over a revolution or hunting period."""
