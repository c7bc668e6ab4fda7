"""The format of bags: writing and reading them."""
