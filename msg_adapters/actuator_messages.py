"""What actuators publish at a tick, as prepared CDR bytes."""

from collections.abc import Sequence

from isa_ros.core.signals import SAMPLE
from msg_adapters import applied_parameters, fluid_pressure, joint_state, wrench
from msg_adapters.cdr import Message
from msg_adapters.template import Fields, Template
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
APPLIED_PARAMETERS = ('applied_parameters', applied_parameters.TYPE)
APPLIED_TOPICS = (APPLIED_PARAMETERS, APPLIED_SETPOINT)
"""The same of what is published when something takes effect."""

TOPICS = (*APPLIED_TOPICS, *STATE_TOPICS)

_FLOAT = np.dtype('<f8')
_SAMPLED = tuple(SAMPLE.names or ())
_PRESSURES = slice(_SAMPLED.index('pressure_a'), _SAMPLED.index('pressure_b') + 1)
_WIDTH = len(_SAMPLED) + 2  # values of one actuator: its sample, then absolute pressures


class StateMessages:
    """
    Prepared state messages of the actuators of a process, (name, whether rotary) each.

    Frames: ``NAME_load_cell``, ``NAME_pressure_a``, ``NAME_pressure_b``; ``NAME`` for the
    rest.
    """

    def __init__(self, actuators: Sequence[tuple[str, bool]]) -> None:
        n = len(actuators)
        self._template = Template(
            [message for row, (name, is_rotary) in enumerate(actuators)
             for message in _prepared(name, is_rotary, row * _WIDTH)], n * _WIDTH)
        table = self._template.values.reshape(n, _WIDTH)
        self._sampled, self._absolute = table[:, :len(_SAMPLED)], table[:, len(_SAMPLED):]
        self._gauge = self._sampled[:, _PRESSURES]

    def pack(self, samples: np.ndarray, t_ns: int) -> list[bytes]:
        """Return the CDR bytes of (n,) SAMPLE rows at ``t_ns``: `STATE_TOPICS` of each."""
        self._sampled[:] = samples.view(_FLOAT).reshape(self._sampled.shape)
        np.add(self._gauge, fluid_pressure.ATMOSPHERE, self._absolute)
        return self._template.pack(t_ns)


def _prepared(name: str, is_rotary: bool, first: int) -> list[tuple[Message, Fields]]:
    """Return the messages of `STATE_TOPICS`; the actuator's values begin at ``first``."""
    columns = {field: first + k for k, field in enumerate(_SAMPLED)}
    absolute = first + len(_SAMPLED)
    prepared = {
        'joint_states': joint_state.actuator_joint_state(name, columns),
        'load_cell': wrench.load_cell(name, is_rotary, columns),
        'pressure_a': fluid_pressure.fluid_pressure(f'{name}_pressure_a', absolute),
        'pressure_b': fluid_pressure.fluid_pressure(f'{name}_pressure_b', absolute + 1),
        'references': joint_state.references(name, columns),
        'valve': joint_state.valve(name, columns),
    }
    return [prepared[suffix] for suffix, _ in STATE_TOPICS]
