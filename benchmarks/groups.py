"""The groups of rows that `isa_ros.bench.groups` adds in a checkout."""

from benchmarks import growth
from benchmarks.bus import bus_rows
from benchmarks.bus_ring import missing
from benchmarks.comparison import comparison_rows, specs
from isa_ros.bench.groups import alone, BenchGroup

GROUPS = (
    BenchGroup('growth', 'From 1 to 24 actuators, recording', growth.growth_rows, growth.specs,
               growth.drawing),
    BenchGroup('peers', 'The same exchange over other middlewares', comparison_rows, specs),
    BenchGroup('bus', 'The actuators on EtherCAT, recording', alone(bus_rows), missing=missing),
)
