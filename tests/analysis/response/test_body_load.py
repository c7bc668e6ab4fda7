"""The load of an actuator that moves a body: named, and that of the body where it is known."""

from isa_ros.analysis.response.body_load import body_load
from isa_ros.analysis.response.choice import Choice, chosen
from isa_ros.analysis.response.rig import Rig, rig
from isa_ros.config.assembly import surroundings_of
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.signals import LOAD_PORT
import numpy as np
import pytest


def measured(actuator: str, name: str = 'crane.yaml', loop: str = 'position',
             **values: float) -> Rig:
    """Return the rig of an actuator; a double underscore stands for a dot."""
    return rig(Choice(name=name, loop=loop, actuator=actuator, values={
        key.replace('__', '.'): value for key, value in values.items()}))


def test_a_position_loop_moves_the_effective_mass_of_its_body():
    """1/m_eff of the port at t = 0, under the force that holds the pose."""
    run = chosen(Choice(name='crane.yaml', loop='position', actuator='lift')).run
    surroundings, ports = surroundings_of(run), np.zeros(2, LOAD_PORT)
    surroundings.ports(ports)
    for row, name in enumerate(('lift', 'tilt')):
        load = measured(name).config.load
        assert load.inertia == pytest.approx(1.0 / ports['inverse_mass'][row], rel=1e-12)
        assert load.force == -surroundings.starts()['force'][row] != 0.0
    assert measured('lift').config.load.inertia > 10e3 > measured('tilt').config.load.inertia


def test_the_title_names_the_load_with_its_mass():
    assert ('mass of 1.545e+04 kg, the effective mass of body at its start pose, at 281.7 mm'
            in measured('lift').title)
    assert ', mass of 50 kg at 50 mm' in rig(
        Choice(name='rig_linear', loop='position')).title


def test_a_given_mass_is_not_that_of_the_body():
    bench = measured('lift', load__inertia=5200.0)
    assert bench.config.load.inertia == bench.inertia == 5200.0
    assert ', mass of 5200 kg, given, not that of body, at ' in bench.title


def test_a_blocked_loop_stays_blocked():
    bench = measured('lift', loop='force')
    assert ', blocked at 281.7 mm' in bench.title and bench.load_source == ''


EXTERNAL = """
name: own
supply: {kind: constant, pressure_mpa: 16.0, return_pressure_mpa: 0.0}
actuators:
  ram: {model: isa_v5}
body: {kind: external, actuators: [ram]}
"""


def test_an_external_body_is_not_known(tmp_path):
    path = tmp_path / 'own.yaml'
    path.write_text(EXTERNAL)
    assert body_load(load_run(path), 'ram') is None
    bench = measured('ram', str(path))
    assert (f", mass of {bench.inertia:g} kg, the model's default, not that of body (--set "
            'load.inertia=), at ') in bench.title
