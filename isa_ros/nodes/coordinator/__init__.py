"""The node of the coordinator, and runs on nodes."""
