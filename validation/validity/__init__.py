"""Where the linear model stops being valid: contact lost, sliding reversed."""
