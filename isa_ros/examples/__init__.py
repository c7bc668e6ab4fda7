"""Programs to copy: in a notebook, as a node, beside the clock."""
