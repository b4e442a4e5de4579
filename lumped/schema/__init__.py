"""The parameters of a gear pair: fields, units, refusals, files."""
