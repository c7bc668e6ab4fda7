"""Linkages of the bodies of a run: drawn, and their lever arms over the stroke."""
