"""The trot of a quadruped."""
