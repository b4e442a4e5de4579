"""The misprints of the paper, each put back to show what it does."""
