"""One machine in exudyn: set up, integrated, recorded."""
