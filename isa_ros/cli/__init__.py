"""The command `isa`."""
