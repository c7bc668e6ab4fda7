"""The state of a simulation: what goes on from it, and what is refused."""

from dataclasses import replace
import math
import struct

from isa_ros.controller import Controller
from isa_ros.errors import ConfigError, IsaError, RunError, SimulationDiverged
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
import pytest
from tests.counted import Counter, drop, RUN, shows, stepped


@pytest.mark.parametrize('has_controller', [False, True])
def test_it_goes_on_from_its_middle_byte_for_byte(has_controller):
    """With what controllers asked for, what was commanded and tuned but not in force yet."""
    def made() -> Simulation:
        return Simulation(drop(), [Counter('kfe', 0.05), Counter('hfe', 0.03)]
                          if has_controller else [])
    simulation = made()
    stepped(simulation, 60)  # before the slider is released
    simulation.command('haa', position=0.8)
    simulation.group.actuators[2].tune({'force.kp': 1e-7})
    saved = simulation.snapshot()
    then, samples = simulation.ticks, simulation.samples['kfe'].tobytes()
    rest = stepped(simulation, 100)
    other = made()
    for again in (simulation, other):
        assert again.restore(saved)['kfe'].tobytes() == samples
        assert again.ticks == then
        assert stepped(again, 100) == rest
        assert again.snapshot() == simulation.snapshot()


def test_a_state_of_another_run_or_of_other_controllers_is_refused():
    saved = Simulation(idle(RUN), [Counter()]).snapshot()
    with pytest.raises(ConfigError, match='saved from the configuration .*, must be that of this'):
        Simulation(drop(), [Counter()]).restore(saved)
    with pytest.raises(ConfigError, match='the saved state has 3 participants, the run has 2'):
        Simulation(idle(RUN)).restore(saved)


class Refusing(Counter):
    """A counter that goes on from no state of another one."""

    def restore(self, snapshot: bytes) -> None:
        super().restore(snapshot)
        if self.count != self.own:
            raise ValueError(f'not my {self.count}')

    def snapshot(self) -> bytes:
        self.own = self.count
        return super().snapshot()


def with_nan(saved: bytes, offset: int) -> bytes:
    """Return a state with a number that is not finite at a place."""
    return saved[:offset] + struct.pack('<d', math.nan) + saved[offset + 8:]


@pytest.mark.parametrize('damaged', [
    lambda state: replace(state, participants=state.participants[:2]),
    lambda state: replace(state, participants=[
        *state.participants[:2], b'', *state.participants[3:]]),
    lambda state: replace(state, load=with_nan(state.load, len(state.load) - 8)),
    lambda state: replace(state, requests=b''),
    lambda state: state], ids=['participants', 'actuator', 'body', 'requests', 'controller'])
def test_a_state_of_which_a_part_is_refused_changes_nothing(damaged):
    """Whichever part it is, those before it are as they were, and so is all that follows."""
    def made() -> Simulation:
        simulation = Simulation(drop(), [Counter('kfe', 0.05), Refusing('hfe', 0.03)])
        stepped(simulation, 70)
        simulation.command('haa', position=0.8)
        simulation.group.actuators[1].tune({'force.kp': 2e-7})
        return simulation
    simulation, undisturbed = made(), made()
    simulation.snapshot()
    other = Simulation(drop(), [Counter('kfe', 0.04), Counter('hfe', 0.02)])
    stepped(other, 90)
    other.group.actuators[0].tune({'force.kp': 1e-7})
    before, shown = undisturbed.snapshot(), shows(undisturbed)
    with pytest.raises(IsaError):
        simulation.resume(damaged(other.state()))
    assert (simulation.ticks, shows(simulation)) == (70, shown)
    assert simulation.snapshot() == before
    assert stepped(simulation, 30) == stepped(undisturbed, 30)


def test_what_cannot_go_on_can_be_restored():
    """A state that is not finite is not kept in case the new one is refused."""
    simulation = Simulation(drop())
    saved = simulation.snapshot()
    simulation.group.actuators[0].memory.states[0, 0] = math.nan
    with pytest.raises(SimulationDiverged):
        simulation.snapshot()
    simulation.restore(saved)
    assert simulation.snapshot() == saved


@pytest.mark.parametrize('saved', [b'\xff\xfe', b'', b'{}', bytes(range(256))])
def test_bytes_that_are_no_state_are_refused(saved: bytes) -> None:
    with pytest.raises(ConfigError, match='is not a saved state|no saved state|not a state'):
        Simulation(idle(RUN)).restore(saved)


def test_a_controller_that_keeps_its_state_to_itself_cannot_be_saved():
    with pytest.raises(RunError, match=r'Controller has no snapshot\(\)'):
        Simulation(idle(RUN), [Controller()]).snapshot()
