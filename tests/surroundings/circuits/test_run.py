"""Circuits in runs: bag, replay, saved states and the emergency stop."""

from pathlib import Path

from isa_ros.analysis.report.energy import energy_table, parts_table, recorded_accounts, text_of
from isa_ros.analysis.signals.recorded_result import read as read_bag
from isa_ros.bag.reader import Bag
from isa_ros.config.assembly import surroundings_of
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.errors import ConfigError
from isa_ros.replay.replay import recorded_inputs
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE, SUPPLY_STATE
from isa_ros.tick.trips import TripWarning
import numpy as np
import pytest
from tests.replay.replayed import content, replayed, result_of

SCENARIO = {'name': 'pumped', 'duration_s': 0.12, 'tracks': {
    'left': [
        {'t_s': 0.0, 'position': 'hold'},
        {'t_s': 0.02, 'position': 'hold', 'sine': {'amplitude': 0.02, 'frequency_hz': 3.0}}]},
    'faults': [{'t_s': 0.05, 'supply': 'station', 'set': {'parts.press_hose.burst': 0.02},
                'until_s': 0.08},
               {'t_s': 0.06, 'supply': 'station', 'set': {'parts.buffer.gas_lost': 0.3}},
               {'t_s': 0.09, 'emergency_stop': 'all'}]}
RUN = load('pump_station', SCENARIO).replace(
    {'emergency_stops': {'all': {'dumps': 'at_once'}}})


@pytest.fixture(scope='module')
def result() -> Result:
    return result_of(RUN.scenario)


def test_a_run_replays_byte_for_byte(result: Result, tmp_path: Path) -> None:
    """With its faults, from what is recorded."""
    bag = result.save(tmp_path / 'bag')
    assert replayed(bag, tmp_path / 'again') == content(bag)
    tuned = recorded_inputs(Bag(bag), RUN.configuration).tuned_supplies
    assert tuned[50] == {'station.parts.press_hose.burst': 0.02}
    assert tuned[80] == {'station.parts.press_hose.burst': 0.0}
    assert 'station.dump.opened' in {key for values in tuned.values() for key in values}


def test_a_bag_has_pressures_of_manifolds_and_accounts_of_parts(
        result: Result, tmp_path: Path) -> None:
    bag = result.save(tmp_path / 'bag')
    topics = {message.topic for message in Bag(bag).messages()}
    assert {'/coordinator/station_pressure', '/station/press_pressure',
            '/station/drain_pressure'} <= topics
    assert not topics & {'/station/pump_pressure', '/station/buffer_pressure',
                         '/station/press_gas_temperature'}
    types = Bag(bag).types
    assert {types[f'/station/{name}_gas_temperature'] for name in ('buffer', 'tool_buffer')} == {
        'sensor_msgs/msg/Temperature'}
    read = read_bag(bag)
    for name in ('station/buffer', 'station/tool_buffer'):
        found = read[f'{name}.gas_temperature']
        assert (found == result[f'{name}.gas_temperature']).all() and np.ptp(found) > 0.05
        assert read.units[f'{name}.gas_temperature'] == 'celsius'
    found = recorded_accounts(Bag(bag))
    assert found is not None
    for name in ('station', 'station/press_hose', 'station/pump'):
        # diagnostics have nine digits
        assert found.by_name[name] == pytest.approx(result.accounts[name], rel=1e-8, abs=1e-8)


def test_actuators_have_the_pressures_of_their_manifolds(result: Result) -> None:
    """And the account of the whole closes, through all faults."""
    assert result['station/press.pressure'][0] == pytest.approx(
        result['station/tool.pressure'][0], rel=1e-12)
    # before the tool's accumulator loses gas
    assert result['station/press.pressure'][59] < result['station/tool.pressure'][59]
    account = result.accounts['station']
    out = [account[f'{name} (J)'] for name in (
        'hydraulic energy', 'relief', 'return', 'stored')]
    into = account['pump (J)'] + account['pressures held over a tick (J)']
    assert into == pytest.approx(sum(out), abs=1e-6 * max(map(abs, out)))
    oil = sum(result.accounts[name]['oil drawn (l)'] for name in ('left', 'right'))
    assert account['oil drawn (l)'] - result.accounts['clamp']['oil drawn (l)'] == pytest.approx(
        oil, rel=1e-9)


def test_a_saved_run_goes_on_byte_for_byte(result: Result) -> None:
    """From the middle of its faults."""
    first, second = Simulation(RUN.scenario), Simulation(RUN.scenario)
    for _ in range(70):
        first.step()
    second.restore(first.snapshot())
    for _ in range(50):
        second.step()
    ends = second.surroundings.supplies
    restored = Simulation(RUN.scenario)
    restored.restore(first.snapshot())
    assert restored.surroundings.supplies.tobytes() == result.log.supplies[70].tobytes()
    assert ends.tobytes() == result.log.supplies[-1].tobytes()


def test_surroundings_fill_ports_by_manifold_and_restore_or_refuse() -> None:
    surroundings, other = (surroundings_of(RUN.configuration) for _ in range(2))
    replies, ports = np.zeros(3, LOAD_REPLY), np.zeros(3, LOAD_PORT)
    replies['supply_volume'], replies['return_volume'] = [1e-7, 1e-7, 0.0], [1e-7, 0.0, 0.0]
    for _ in range(5):
        surroundings.ports(ports)
        surroundings.advance(replies)
    surroundings.ports(ports)
    assert ports['supply_pressure'][0] == ports['supply_pressure'][1]
    assert ports['supply_pressure'][0] < ports['supply_pressure'][2]
    assert (ports['return_pressure'] > 0.0).all()
    assert len(set(ports['return_pressure'])) == 1
    saved = surroundings.snapshot()
    other.restore(saved)
    assert other.snapshot() == saved
    broken = bytearray(saved)
    broken[-8:] = b'\xff' * 8
    with pytest.raises(ConfigError, match='station: saved state is not one of this circuit'):
        other.restore(bytes(broken))
    assert other.snapshot() == saved
    with pytest.raises(ConfigError, match='saved state of the surroundings has'):
        other.restore(saved[:-8])


def test_a_saved_state_has_the_signals_that_it_always_had() -> None:
    """14 numbers a row, behind the accounts nothing that follows from the circuit's own state."""
    surroundings = surroundings_of(RUN.configuration)
    assert SUPPLY_STATE.names == SUPPLY_SAMPLE.names[:14] and 'gas_temperature' in (
        SUPPLY_SAMPLE.names[14:])
    states = np.frombuffer(surroundings.snapshot(), SUPPLY_STATE, len(surroundings.supplies))
    for name in SUPPLY_STATE.names or ():
        assert (states[name] == surroundings.supplies[name]).all()
    assert np.ptp(states['pressure']) > 1e6


def test_the_message_of_the_page_is_that_of_the_command() -> None:
    """A manifold too small for its valve."""
    page = (Path(__file__).parents[3] / 'docs' / 'parts.md').read_text(encoding='utf-8')
    small = load('pump_station').replace({'supplies.station.parts.branch.oil_volume_l': 0.005})
    with pytest.raises(ConfigError) as refused:
        surroundings_of(small.configuration)
    assert f'isa: {refused.value}' in ' '.join(page.split())


def test_a_report_has_a_table_of_the_parts(result: Result, tmp_path: Path) -> None:
    """What went in and out, was given, lost and stored; the other table has no rows of parts."""
    accounts = recorded_accounts(Bag(result.save(tmp_path / 'bag')))
    assert accounts is not None
    assert [row[0] for row in energy_table(accounts)] == ['', 'left', 'right', 'clamp', 'station']
    head, *rows = parts_table(accounts)
    assert [row[0] for row in rows] == ['station', *(
        f'station/{name}' for name in RUN.configuration.supplies[0].sheet.by_name)]
    by_name = {row[0]: dict(zip(head, row)) for row in rows}
    pump = result.accounts['station/pump']
    assert float(by_name['station/pump']['given, J']) == pytest.approx(pump['pump (J)'], rel=1e-2)
    assert float(by_name['station/emptied']['lost, J']) > 0.0
    assert text_of(recorded_accounts(Bag(tmp_path / 'bag'))).count('station/') == len(rows) - 1
    whole = by_name['station']
    given = float(whole['given, J']) + float(whole['held, J'])
    # rounded to three digits each
    assert given == pytest.approx(sum(float(whole[key]) for key in (
        'lost, J', 'stored, J', 'return, J', 'actuators, J')), abs=0.01 * given)
    assert whole['oil in, l'] == ''


def test_the_pressure_of_an_empty_manifold_stands_at_the_vapour_s() -> None:
    """
    What actuators draw makes its cavity larger, and no tension of the oil.

    Within a tick that begins with little oil the pressure may fall on, by what is drawn in it.
    """
    with pytest.warns(TripWarning):
        result = load('pump_station', duration=0.35).simulate(
            faults=[{'t_s': 0.02, 'supply': 'station', 'set': {'dump.opened': 1}}])
    node = result['station/press.pressure'][:-1]
    empty = np.flatnonzero(node <= -0.99e5) + 1     # the ticks that begin so
    read = result['left.supply_pressure']
    assert len(empty) > 10 and read[empty].min() == pytest.approx(-1e5, abs=2e4)
    assert read.min() > -0.6e6


def test_a_cavity_has_no_elastance() -> None:
    surroundings = surroundings_of(RUN.configuration)
    station = surroundings._circuits[0]
    press = station._nodes[0]
    full = station.nodes()[0].capacity
    assert 0.0 < full < 1e-11
    station._held[press] = -1e5
    assert station.nodes()[0].capacity == np.inf
    station._held[press] = -0.999e5
    assert station.nodes()[0].capacity == pytest.approx(full, rel=1e-9, abs=0.0)
