"""
Peers: other middlewares that transmit the steps of a run, for comparison.

A peer is one file with two functions that return its ends, each a `PeerEnd`. Steps, answers,
actuators, shared load and recorder are those of every run: only the middleware differs, and the
bag is the same byte for byte. To add one, write the file and add one line to `catalogue.PEERS`.
"""
