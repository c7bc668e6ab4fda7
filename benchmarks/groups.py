"""The groups of rows that `isa_ros.bench.groups` adds in a checkout."""

from benchmarks.bus import bus_rows
from benchmarks.bus_ring import missing
from benchmarks.comparison import comparison_rows, specs
from isa_ros.bench.groups import alone, Group

GROUPS = (
    Group('peers', 'The same exchange over other middlewares', comparison_rows, specs),
    Group('bus', 'The actuators on EtherCAT, recording', alone(bus_rows), missing=missing),
)
