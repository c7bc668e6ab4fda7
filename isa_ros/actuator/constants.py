"""The constants of an actuator's row, and digests that are equal where all parameters are."""

import hashlib

from isa_ros.actuator.config import ConfiguredActuator
from isa_ros.actuator.link import link_key
from isa_ros.actuator.rows import Memory
from isa_ros.actuator.sheet import actuator_record
from isa_ros.actuator.timing import Timing
from isa_ros.core.noise import noise_key
from isa_ros.loads.sheets import own_record
from isa_ros.reu.cascade import initial_gains


def write_constants(config: ConfiguredActuator, timing: Timing, memory: Memory) -> None:
    """Write the constants of an actuator into its row of the memory."""
    memory.is_shared[0] = config.load is None
    constants = memory.constants
    constants[:] = actuator_record(config.sheet, timing.offset_steps)
    constants['load'] = own_record(config.load)
    constants['noise_key'] = noise_key(timing.seed, config.name)
    constants['link_key'] = link_key(timing.seed, config.name)


def digest_of(config: ConfiguredActuator, timing: Timing, mode: int, memory: Memory) -> str:
    """Return a hash of every resolved parameter; ``mode`` is that of the start, a number."""
    text = f'{timing} {config.load} {initial_gains(config.sheet.reu)} {mode} {config.auto_enable}'
    return hashlib.sha256(memory.constants.tobytes() + text.encode()).hexdigest()[:16]


def participant_digest(digest: str, timing: Timing) -> str:
    """Return a hash of the parameters and the timing of an actuator with a `digest_of`."""
    return f'{digest}/{timing.step_ns}/{timing.controller_offset_ns}/{timing.start_ns}'
