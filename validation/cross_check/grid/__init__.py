"""The cross-check over many presets, laws, speeds and torques."""
