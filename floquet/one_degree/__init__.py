"""One degree of freedom: the gear pair on rigid bearings, and closed forms of its motion."""
