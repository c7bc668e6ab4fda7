"""
Other ways to carry the steps of a run: what the same work costs over them.

A peer is one file with two functions that give the ends of a `Link`; the steps, the answers,
the actuators, the shared load and the recorder are those of every run, so that only the
middleware differs, and the bag is the same byte for byte. To add one, write the file and add
one line to `catalogue.PEERS`.
"""
