"""The processes of a run: starting, forking, watching and ending them."""
