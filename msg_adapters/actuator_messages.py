"""Everything one actuator publishes at a tick, as prepared CDR bytes."""

from isa_ros.signals import SAMPLE
from msg_adapters import fluid_pressure, joint_state, wrench
from msg_adapters.setpoint import AppliedSetpoint
from msg_adapters.template import stamp, Template
import numpy as np

STATE_TOPICS = (
    ('joint_states', joint_state.TYPE),
    ('load_cell', wrench.TYPE),
    ('pressure_a', fluid_pressure.TYPE),
    ('pressure_b', fluid_pressure.TYPE),
    ('references', joint_state.TYPE),
    ('valve', joint_state.TYPE),
)
"""(topic suffix, type) of what is published at every tick, sorted by suffix."""

APPLIED_SETPOINT = ('applied_setpoint', joint_state.TYPE)
TOPICS = tuple(sorted((*STATE_TOPICS, APPLIED_SETPOINT)))

_N_STAMP = 2


class ActuatorMessages:
    """
    Prepared messages of one actuator.

    Frames: ``NAME_load_cell``, ``NAME_pressure_a``, ``NAME_pressure_b``; ``NAME`` for the
    rest.
    """

    def __init__(self, name: str, is_rotary: bool) -> None:
        self.name = name
        self._applied = AppliedSetpoint(name)
        columns = {field: _N_STAMP + k for k, field in enumerate(SAMPLE.names or ())}
        n = _N_STAMP + len(columns)
        prepared = {
            'joint_states': joint_state.actuator_joint_state(name, columns),
            'load_cell': wrench.load_cell(name, is_rotary, columns),
            'pressure_a': fluid_pressure.fluid_pressure(f'{name}_pressure_a', n),
            'pressure_b': fluid_pressure.fluid_pressure(f'{name}_pressure_b', n + 1),
            'references': joint_state.references(name, columns),
            'valve': joint_state.valve(name, columns),
        }
        self._suffixes = [suffix for suffix, _ in STATE_TOPICS]
        self._template = Template([prepared[suffix] for suffix in self._suffixes], n + 2)
        self._pressure_a = columns['pressure_a'] - _N_STAMP
        self._pressure_b = columns['pressure_b'] - _N_STAMP

    def state(self, sample: np.void, t_ns: int) -> list[tuple[str, bytes]]:
        """Return (topic suffix, CDR bytes) of a SAMPLE row at ``t_ns``, as `STATE_TOPICS`."""
        values = sample.item()
        data = self._template.pack((
            *stamp(t_ns), *values,
            fluid_pressure.absolute(values[self._pressure_a]),
            fluid_pressure.absolute(values[self._pressure_b])))
        return list(zip(self._suffixes, data))

    def applied_setpoint(self, command: np.void, t_ns: int) -> tuple[str, bytes]:
        """Return (topic suffix, CDR bytes) of a COMMAND row, its gains resolved."""
        return APPLIED_SETPOINT[0], self._applied.pack(command, t_ns)
