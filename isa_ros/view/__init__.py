"""A page on localhost that shows a run while it goes on, or plays a bag."""
