"""The prediction for a pair, the range with the uncertain inputs, and the size of each error."""
