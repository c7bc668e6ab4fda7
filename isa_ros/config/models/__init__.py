"""Models of actuators: their sheets, presets, variants, loads, wires and named faults."""
