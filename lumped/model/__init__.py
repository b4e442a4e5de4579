"""The linear time-varying model: equations, periodic motion, transients, sweeps."""
