"""Stiffness of the bearings that hold the gears, from what a catalogue says of them."""
