"""Every group of checks, in the order of the paper; the package says how to add one."""

from isa_ros.analysis.validation.actuator_data import actuator_data
from isa_ros.analysis.validation.current_loop import current_loop
from isa_ros.analysis.validation.entry import Group
from isa_ros.analysis.validation.strokes import strokes
from isa_ros.analysis.validation.valve_dynamics import valve_dynamics
from isa_ros.analysis.validation.valve_flow import valve_flow

GROUPS = (
    Group('valve_flow', 'Flow and leakage of the valves (Figs 5 and 6)', valve_flow),
    Group('valve_dynamics', 'Frequency response of the valves (Fig 4)', valve_dynamics),
    Group('current_loop', 'Current and spool loop (Figs 4 and 8)', current_loop, is_long=True),
    Group('strokes', 'Force and torque control over the stroke', strokes, is_long=True),
    Group('actuator_data', 'Data of the actuators (Tables 2, 3, 5)', actuator_data),
)
