"""Data of the paper's figures 2 to 7, one module each; no plotting here."""
