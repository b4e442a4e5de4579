"""Models of spur gear pairs by engineers who did not write spurcheck, and the mistakes that they make."""
