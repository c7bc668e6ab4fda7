"""
Rows of `isa bench` that need a checkout: many actuators, other middlewares, the master of a bus.

This folder is not installed. `isa_ros.bench` says how a group of rows is added.
"""
