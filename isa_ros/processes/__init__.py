"""The processes of a run: starting, copying, watching and ending them."""
