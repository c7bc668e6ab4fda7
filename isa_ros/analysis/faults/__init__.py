"""`isa faults`: every fault of the device injected into a running rig."""
