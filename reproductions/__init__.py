"""Published work computed again; each folder has its own page. Nothing in the library imports it."""
