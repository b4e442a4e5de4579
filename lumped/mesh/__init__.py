"""The forces between the teeth that mesh: how an approach of the gears becomes a force."""
