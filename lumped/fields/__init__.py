"""Fields of parameter files: sections, quantities with units, text files, refusals in the user's words."""
