"""Layouts of plotting tools, made of what a run publishes: `python -m scripts.write_layouts`."""
