"""Both gears as they are cut."""
