"""One-step methods for X' = A(t) X, one small file per family, and the registry of their names."""
