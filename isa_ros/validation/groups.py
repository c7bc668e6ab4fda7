"""Every group of checks, in the order of the paper; see the package on how to add one."""

from isa_ros.validation.actuator_data import actuator_data
from isa_ros.validation.behaviour import behaviour
from isa_ros.validation.cavities import cavities
from isa_ros.validation.current_loop import current_loop
from isa_ros.validation.entry import CheckGroup
from isa_ros.validation.isa_v5 import isa_v5
from isa_ros.validation.knee_rig import knee_rig
from isa_ros.validation.limits import limits
from isa_ros.validation.numerics import numerics
from isa_ros.validation.reu_statics import reu_statics
from isa_ros.validation.rotary_disturbances import rotary_disturbances
from isa_ros.validation.rotary_rig import rotary_rig
from isa_ros.validation.strokes import strokes
from isa_ros.validation.valve_dynamics import valve_dynamics
from isa_ros.validation.valve_flow import valve_flow
from isa_ros.validation.valve_leakage import valve_leakage

GROUPS = (
    CheckGroup('valve_flow', 'Flow gain of the valves (Fig 5)', valve_flow),
    CheckGroup('valve_leakage', 'Leakage of the valves (Fig 6)', valve_leakage),
    CheckGroup('valve_dynamics', 'Frequency response of the valves (Fig 4)', valve_dynamics),
    CheckGroup('current_loop', 'The current loop around its coil (Fig 8)', current_loop,
               is_long=True),
    CheckGroup('actuator_data', 'Data of the actuators (Tables 2, 3, 5)', actuator_data),
    CheckGroup('behaviour', 'Friction, oil and valve in simulation', behaviour,
               is_long=True),
    CheckGroup('limits', 'Largest speed and force, end stops and converters in simulation',
               limits),
    CheckGroup('cavities', 'Cavities in simulation', cavities),
    CheckGroup('reu_statics', 'Gains and rates of the control blocks (Fig 7, Table 4)',
               reu_statics),
    CheckGroup('rotary_rig', 'Torque control of the rotary rig (Figs 12, 13)', rotary_rig,
               is_long=True),
    CheckGroup('rotary_disturbances', 'Impacts and weights on the rotary rig (Figs 15 to 18)',
               rotary_disturbances, is_long=True),
    CheckGroup('strokes', 'Force and torque control over the stroke', strokes, is_long=True),
    CheckGroup('isa_v5', 'Force control of the ISA v5, relief valves (Table 4, section 2.7)',
               isa_v5, is_long=True),
    CheckGroup('knee_rig', 'The knee rig (Figs 14, 19, 20)', knee_rig, is_long=True),
    CheckGroup('numerics', 'The solver and the linkages', numerics, is_long=True),
)
