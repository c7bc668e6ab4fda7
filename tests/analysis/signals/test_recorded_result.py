"""`isa_ros.read`: a bag gives the columns, units, accounts and events of the run's result."""

from pathlib import Path
import re

import isa_ros
from isa_ros.analysis.report.report import recorded, write_report
from isa_ros.analysis.signals import recorded_result
from isa_ros.bag.reader import Bag
from isa_ros.config.recorded_run import recorded_run
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.errors import BagError, ConfigError
from isa_ros.run.diagnostics import ENERGY
from isa_ros.run.recorded import history_of
from isa_ros.testing import assert_no_trips
from msg_adapters import diagnostics
import numpy as np
import pytest
from tests.bag.golden import GOLDEN, rewrite

DIGITS = 1e-8       # of a number in /diagnostics: 9 digits


@pytest.fixture(scope='module')
def drop() -> isa_ros.Result:
    return isa_ros.load('leg', 'drop', duration=0.05).simulate()


@pytest.fixture(scope='module')
def bag(drop, tmp_path_factory) -> Path:
    return drop.save(tmp_path_factory.mktemp('read') / 'bag')


def test_columns_are_those_of_the_result_bit_for_bit_where_messages_have_them(drop, bag):
    """Accounts have 9 digits, at their ticks; the event before a fault is in words only."""
    read = isa_ros.read(str(bag))
    assert (read.time == drop.time).all() and repr(read).endswith('51 samples to t = 0.05 s>')
    assert set(read) < set(drop) and read.units == {name: drop.units[name] for name in read}
    exact = [f'{name}.{field}' for name in ('haa', 'hfe', 'kfe') for field in (
        'position', 'velocity', 'force', 'pressure_a', 'spool', 'current_reference',
        'supply_volume', 'trips', 'device_mode')]
    for name in (*exact, 'supply.pressure', 'body.position', 'body.foot_force'):
        assert (read[name] == drop[name]).all(), name
        assert not read[name].flags.writeable
    assert (drop['kfe.force'][1:] != drop['kfe.force'][:-1]).any()
    energy = read['kfe.hydraulic_energy']
    assert np.isnan(energy[2:-1]).all() and energy[-1] == pytest.approx(
        drop['kfe.hydraulic_energy'][-1], rel=DIGITS)
    assert 'kfe.power' in drop and 'kfe.power' not in read and 'kfe.power' not in read.units
    with pytest.raises(KeyError, match='kfe.power is unknown'):
        read['kfe.power']


def test_accounts_configuration_and_commands_are_those_of_the_run(drop, bag):
    read = isa_ros.read(bag)
    assert read.accounts.keys() == drop.accounts.keys()
    for name, account in drop.accounts.items():
        assert read.accounts[name] == pytest.approx(account, rel=DIGITS, abs=1e-12)
    assert read.scenario.run == drop.scenario.run and read.problem == ''
    assert read.scenario.tracks == drop.scenario.tracks
    assert read.log.applied.keys() == drop.log.applied.keys()
    for tick, rows in read.log.applied.items():
        assert (rows['position'] == drop.log.applied[tick]['position']).all()


def test_what_was_read_is_not_written_again(bag, tmp_path):
    with pytest.raises(BagError, match='not written, the result was read from .*bag, which is'):
        isa_ros.read(bag).save(tmp_path / 'again')
    assert not (tmp_path / 'again').exists()


def test_a_run_that_continued_a_state_is_read_from_its_first_tick(bag, tmp_path):
    """Before it nothing is known."""
    late = rewrite(Bag(bag), tmp_path / 'late', without=('/hfe/device',))
    read = isa_ros.read(late)
    assert np.isfinite(read['hfe.device_state']).all()      # /diagnostics has it too
    bare = rewrite(Bag(bag), tmp_path / 'bare', without=(
        '/diagnostics', *(f'/{name}/device' for name in ('haa', 'hfe', 'kfe'))))
    read = isa_ros.read(bare)
    assert 'hfe.device_state' not in read and read.events == [] == read.trips
    assert np.isnan(read.accounts['kfe']['hydraulic energy (J)'])


def older(text: str) -> str:
    """Return a configuration as another version might have written it."""
    text, count = re.subn(r'^( +)kf: (.*)$', r'\1kf: \2\n\1magic: 1.0', text, flags=re.MULTILINE)
    text, models = re.subn('model: isa_v5', 'model: isa_v9', text)
    text, rotary = re.subn('model: smart_manifold', 'model: manifold_9', text)
    text, legs = re.subn('model: hyq_real', 'model: hyq_next', text)
    assert count and models == 2 and legs == rotary == 1
    return text


def test_a_bag_of_another_version_is_read_and_reported(bag, drop, tmp_path):
    """An unknown key and models: signals, units, events and oil need none of them."""
    old = rewrite(Bag(bag), tmp_path / 'old', configuration=older)
    read = isa_ros.read(old)
    assert 'magic is unknown' in read.problem
    assert set(read) == set(isa_ros.read(bag)) and read.units['haa.force'] == 'Nm'
    assert (read['kfe.force'] == drop['kfe.force']).all() and len(read.accounts) == 4
    page, *figures = write_report(recorded(old), tmp_path / 'report.html')
    assert 'Another version recorded this bag' in page.read_text() and len(figures) == 8
    own, *_ = write_report(recorded(bag), tmp_path / 'own.html')
    assert 'Another version' not in own.read_text()
    assert_no_trips(old)


def test_a_configuration_without_actuators_is_refused_with_its_own_reason():
    with pytest.raises(ConfigError, match='^old.yaml: magic is unknown'):
        recorded_run('{name: x, magic: 1}', 'old.yaml')
    text = Bag(GOLDEN / 'rotor_step').provenance.configuration
    own = recorded_run(text, 'own')
    assert own.problem == '' and own.run == run_of_text(text)


def test_a_cavity_in_the_diagnostics_of_a_bag_is_an_event(tmp_path):
    """One row for each tick, though devices and diagnostics have messages at the same."""
    run = isa_ros.load('rig_linear', duration=0.02)
    plain = Bag(run.simulate().save(tmp_path / 'plain'))
    ticks = history_of(plain, run.configuration).ticks
    assert list(ticks) == sorted(set(ticks)) and len(ticks) > 1

    def with_cavity(topic: str, sequence: int, data: bytes) -> bytes:
        if topic != diagnostics.TOPIC[0]:
            return data
        return diagnostics.pack(sequence * 1_000_000, [
            diagnostics.Status('ram', ENERGY, '', {'largest cavity (ml)': 0.5})])
    found = isa_ros.read(rewrite(plain, tmp_path / 'cavity', with_cavity)).events
    assert ('ram', 'cavity', 'vapour in a chamber, at most 0.5 ml') in [own[1:] for own in found]


def test_a_scenario_that_cannot_be_read_leaves_the_signals(bag, drop, monkeypatch):
    def refuse(*given: object) -> None:
        raise ConfigError('of another version')
    monkeypatch.setattr(recorded_result, 'scenario_of', refuse)
    read = isa_ros.read(bag)
    assert read.scenario.tracks == () and read.scenario.n_ticks == 50
    assert (read['kfe.force'] == drop['kfe.force']).all()


def test_a_trip_of_a_bag_without_values_of_trips_is_found(tmp_path):
    """As bags of before: the set of conditions alone, at two states of one trip."""
    fault = {'t_s': 0.01, 'actuator': 'ram', 'set': {'plant.sensors.pressure_a.bias': -1e8}}
    with pytest.warns(isa_ros.TripWarning):
        result = isa_ros.load('rig_linear', duration=0.1).simulate(faults=[fault])
    bag = Bag(result.save(tmp_path / 'bag'))

    def without_values(topic: str, sequence: int, data: bytes) -> bytes:
        return data.replace(b'last_fault', b'lost_fault')
    old = rewrite(bag, tmp_path / 'old', without_values)
    trip, = isa_ros.read(old).trips
    (known,) = result.trips
    assert trip[:2] == known[:2] and trip.value is None is trip.level
    assert trip.t_s == pytest.approx(known.t_s, abs=1e-4)
    with pytest.raises(AssertionError, match='load_cell_implausible tripped at t = 0.06'):
        assert_no_trips(old)
