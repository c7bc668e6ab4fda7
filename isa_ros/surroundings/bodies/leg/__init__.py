"""One leg on a vertical slider, moved by three actuators."""
