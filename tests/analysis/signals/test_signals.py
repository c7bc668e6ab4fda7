"""Signals by name: the same of a run in memory and of its bag."""

from pathlib import Path

from isa_ros.analysis.signals.signals import read_signals, signals_of
from isa_ros.core.accounts import FIELDS
from isa_ros.core.device import FIELDS as DEVICE
from isa_ros.errors import BagError
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import load
import numpy as np
import pytest

PUBLISHED = (   # of the leg's sample
    'position', 'velocity', 'torque', 'foot_force', 'height', 'height_velocity', 'foot_moment')
GAUGE = 2e-9    # Pa: half a step of a float of 20.7 MPa, added and taken away once each


@pytest.fixture(scope='module')
def drop() -> Result:
    """Return the first ticks of the leg's drop."""
    return load('leg', 'drop').simulate(0.05)


@pytest.fixture(scope='module')
def bag(drop: Result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return its bag."""
    return drop.save(tmp_path_factory.mktemp('signals') / 'bag')


def test_a_bag_has_the_signals_of_the_result(drop: Result, bag: Path) -> None:
    """
    Bit for bit, but for pressures, which messages hold as absolute ones.

    Energies, temperatures and devices are there once a second or on change; ages are in stamps,
    the pressure at an actuator's port is that of its supply. That in a cushion is not in a bag.
    """
    read, in_memory = read_signals(bag), signals_of(drop)
    at_times = {'power', 'temperature', 'age', *DEVICE, *FIELDS} - {'supply_volume'}
    at_times |= {'supply_pressure', 'cushion_pressure'}
    expected = {name for name in drop if name.startswith(('haa.', 'hfe.', 'kfe.'))
                and name[4:] not in at_times}
    expected |= {f'body.{name}' for name in PUBLISHED} | {'supply.pressure'}
    assert set(read) == expected and set(in_memory) == set(drop)
    for name in read:
        assert read[name].shape == drop[name].shape
        if 'pressure' in name:
            assert read[name] == pytest.approx(drop[name], rel=0.0, abs=2.0 * GAUGE)
        else:
            assert np.array_equal(read[name], in_memory[name]), name
        assert read.unit(name) == in_memory.unit(name) == drop.units[name]
        assert np.array_equal(read.over_time(name).t, in_memory.over_time(name).t)
    # ns times 1e-9 against ns over 1e9: 1e-9, product and quotient are rounded, by at most
    # 2^-53 of 0.05 s each
    assert np.array_equal(read.time, in_memory.time)
    assert read.time == pytest.approx(drop.time, rel=0.0, abs=2e-17)
    assert len(read) == len(list(read)) and read.run.to_yaml() == drop.scenario.run.to_yaml()


def test_the_unit_of_every_name_is_that_of_the_result(drop: Result) -> None:
    """Also of a rotary actuator, in rad and Nm."""
    for result in (drop, load('rig_rotary', 'step').simulate(0.01)):
        signals = signals_of(result)
        assert {name: signals.unit(name) for name in signals} == dict(result.units)


def test_the_supply_of_an_actuator_is_found_by_name(drop: Result) -> None:
    signals = signals_of(drop)
    assert np.array_equal(signals.supply_pressure('kfe').values, drop['supply.pressure'])


def test_topics_that_were_thinned_have_times_of_their_own(tmp_path: Path) -> None:
    """Every fifth tick of the valve, and no references."""
    result = load('rig_rotary', 'step').replace({
        'record': {'leave_out': ['/*/references'], 'decimate': {'/*/valve': 5}}}).simulate(0.02)
    read = read_signals(result.save(tmp_path / 'bag'))
    t, spool = read.over_time('rotor.spool')
    assert np.array_equal(spool, result['rotor.spool'][::5])
    assert np.array_equal(np.round(1e9 * t), np.arange(0, 21, 5) * 1e6)
    assert np.array_equal(np.round(1e9 * read.time), np.arange(21) * 1e6)
    assert 'rotor.force_reference' not in read
    with pytest.raises(BagError, match='rotor.force_reference is missing, was its topic left out'):
        read['rotor.force_reference']
