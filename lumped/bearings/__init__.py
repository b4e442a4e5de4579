"""Stiffness of the bearings of the gears, from the data of a catalogue."""
