"""A serial line: frames with a checksum over a terminal."""
