"""Film thickness, roughness and viscosity, each by its published formula."""
