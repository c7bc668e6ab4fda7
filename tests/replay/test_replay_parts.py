"""Hoses, load holding, springs, motors and cushions replay, and continue from a saved state."""

from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.replay.replay import Rerun
from isa_ros.scripting.run import load, Run
from isa_ros.simulation import Simulation
import pytest
from tests.parts import TICKS, written
from tests.replay.replayed import content

pytestmark = pytest.mark.filterwarnings('ignore::isa_ros.tick.trips.TripWarning')


@pytest.fixture(scope='module')
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """Return the run with all of these parts."""
    return load(*written(tmp_path_factory.mktemp('parts')))


def test_a_bag_of_all_parts_replays_to_the_byte(run, tmp_path):
    bag = run.simulate().save(tmp_path / 'bag')
    again = Rerun(Bag(bag))
    with BagWriter(tmp_path / 'again', again.topics, Bag(bag).provenance) as writer:
        again.simulate(writer)
    assert content(Path(bag)) == content(tmp_path / 'again')


def shown(simulation: Simulation, ticks: int) -> list[bytes]:
    """Return the samples of all actuators after each of some ticks."""
    found = []
    for _ in range(ticks):
        simulation.step()
        found.append(b''.join(own.tobytes() for own in simulation.samples.values()))
    return found


@pytest.mark.parametrize('tick', [50, 150, 210])
def test_a_state_saved_in_motion_continues_to_the_byte(run, tick):
    """At 50: the slide leaves its cushion; later it returns into it, and a hose has burst."""
    simulation, other = Simulation(run.scenario), Simulation(run.scenario)
    shown(simulation, tick)
    saved = simulation.snapshot()
    rest = shown(simulation, TICKS - tick)
    assert len(set(rest)) == len(rest)      # it moves at every tick
    other.restore(saved)
    assert shown(other, TICKS - tick) == rest
    assert other.snapshot() == simulation.snapshot()


def test_every_part_takes_part(run):
    """The spear is in and out, the poppet on its way, the motor beyond a radian, the table up."""
    found = run.simulate()
    trapped = found['slide.cushion_pressure']
    assert trapped.max() > 1e5 and (trapped == 0.0).any()
    assert found['drum.position'].max() > 2.0 and found['table.position'].max() > 0.03
    assert abs(found['boom.position'] - found['boom.position'][0]).max() > 1e-3
