"""What was run, and how to run it again."""

from pathlib import Path

import isa_ros
from isa_ros.analysis.report.what_ran import VALUES_HEADER, what_ran, WhatRan
from isa_ros.analysis.signals.signals import read_signals
from isa_ros.bag.reader import Bag
from isa_ros.replay.compare import compare_bags
import pytest

CHANGES = {'actuators.ram.parameters.reu.force.kp': 2.5e-7,
           'actuators.ram.parameters.plant.oil.dead_volume_ml': 12.0, 'seed': 7}


@pytest.fixture(scope='module')
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the bag of a rig with another gain, oil volume and seed."""
    rig = isa_ros.load('rig_linear', 'identify_linear', duration=0.05, changes=CHANGES)
    return rig.simulate().save(tmp_path_factory.mktemp('ran') / 'mine')


@pytest.fixture(scope='module')
def ran(bag: Path) -> WhatRan:
    opened = Bag(bag)
    return what_ran(opened, 'mine', read_signals(opened))


def test_it_names_configuration_scenario_versions_and_seed(ran):
    rows = dict(ran.rows)
    assert rows['bag'] == 'mine' and rows['seed'] == '7' and rows['scenario'] == 'identify_linear'
    assert rows['configuration'] == 'rig_linear, resolved from rig_linear.yaml'
    assert rows['duration'] == '0.05 s, 50 ticks of 1 ms'
    assert rows['actuator'] == 'ram: isa_v5, preset default'
    assert f'isa_ros {isa_ros.__version__}' in rows['versions'] and 'numpy' in rows['versions']
    assert len(rows['version.kernels']) == 12


def test_values_that_differ_are_listed_gains_first(ran):
    header, gain, *others = ran.values
    assert header == VALUES_HEADER
    assert gain[:3] == ('ram', 'reu.force.kp', '2.5e-07') and gain[2] != gain[3]
    volumes = [row for row in others if row[1] == 'plant.oil.dead_volume_ml']
    assert [row[2] for row in volumes] == ['12'] and volumes[0][4] == 'ml'


def test_a_shipped_actuator_differs_in_nothing(tmp_path):
    for name in ('rig_linear', 'rig_rotary'):
        own = Bag(isa_ros.load(name).simulate(0.002).save(tmp_path / name))
        assert what_ran(own, name, read_signals(own)).values == [VALUES_HEADER]


def test_a_cylinder_of_the_users_own_is_compared_with_the_model(tmp_path):
    """Units are those of its kind, not of both."""
    own = Bag(isa_ros.load('rig_cylinder').simulate(0.002).save(tmp_path / 'own'))
    rows = what_ran(own, 'own', read_signals(own)).values[1:]
    assert rows and not any(' | ' in row[4] for row in rows)


def test_the_commands_repeat_the_run_byte_for_byte(bag, ran, tmp_path):
    """Of the files of the page; `isa bringup` reads them as `load` does."""
    assert ran.commands == [
        'isa replay mine',
        'isa bringup configuration.yaml --scenario scenario.yaml --out again']
    assert set(ran.files) == {'configuration.yaml', 'scenario.yaml'}
    for name, text in ran.files.items():
        (tmp_path / name).write_text(text)
    again = isa_ros.load(tmp_path / 'configuration.yaml', tmp_path / 'scenario.yaml')
    report = compare_bags(Bag(bag), Bag(again.simulate().save(tmp_path / 'again')))
    assert report.is_equal and report.ticks == 51
