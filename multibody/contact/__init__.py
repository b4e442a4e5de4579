"""Where the teeth touch and what force they carry, from the bodies' own positions."""
