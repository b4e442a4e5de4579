"""What runs are for: power balance, causes of differences, checks of the model itself, pictures."""
