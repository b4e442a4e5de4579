"""The prediction for a pair, how its inputs move it, and how large each error is."""
