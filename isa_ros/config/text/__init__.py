"""Text of configurations: YAML with origins, sections in layers, keys, parameter sets."""
