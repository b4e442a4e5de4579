"""What runs are for: power balance, causes of differences, reversed sliding, pictures."""
