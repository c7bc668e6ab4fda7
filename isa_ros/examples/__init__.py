"""Controllers to copy: one in the lockstep, one beside it."""
