"""Example controllers to copy: one in the lockstep, one outside of it."""
