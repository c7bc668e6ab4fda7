"""The table of oil and energy, from a run in memory and from its bag."""

import isa_ros
from isa_ros.analysis.report.energy import (
    Accounts, energy_table, HEADER, recorded_accounts, text_of)
from isa_ros.analysis.report.report import recorded, write_report
from isa_ros.bag.reader import Bag
from isa_ros.core.accounts import ENERGY, HELD, PUMP, SHARES, SUPPLY_SHARES
import pytest


@pytest.fixture(scope='module')
def drop():
    return isa_ros.load('leg', 'drop').simulate(0.3)


@pytest.fixture(scope='module')
def bag(drop, tmp_path_factory):
    return drop.save(tmp_path_factory.mktemp('energy') / 'bag')


def test_the_bag_has_the_table_of_the_run(drop, bag):
    accounts = recorded_accounts(Bag(bag))
    assert accounts.t == 0.3
    rows = energy_table(accounts)
    assert rows == energy_table(Accounts(0.3, drop.accounts))
    assert rows[0] == HEADER
    assert [row[0] for row in rows[1:]] == ['haa', 'hfe', 'kfe', 'supply']


def test_the_shares_are_those_of_the_columns(drop, bag):
    """And together all of the energy, as far as the digits go."""
    head, _, _, knee, _ = energy_table(recorded_accounts(Bag(bag)))
    cells = dict(zip(head, knee))
    energy = drop['kfe.hydraulic_energy'][-1]
    for name, field in (('valve leakage', 'leakage_energy'), ('throttling', 'throttling_energy'),
                        ('friction', 'friction_energy'), ('work', 'work')):
        share = 100.0 * drop[f'kfe.{field}'][-1] / energy
        assert float(cells[name].split()[0]) == pytest.approx(share, abs=0.0501)
    shares = [float(cell.split()[0]) for cell in knee[5:]]
    assert sum(shares) == pytest.approx(100.0, abs=0.25)
    assert float(cells['energy, J']) == pytest.approx(energy, rel=5e-3)


def test_text_and_page_have_it(bag, tmp_path):
    text = text_of(recorded_accounts(Bag(bag))).splitlines()
    assert text[0].split()[:2] == ['oil,', 'l'] and text[3].startswith('kfe ')
    assert text[5].startswith('up to t = 0.300 s')
    page = write_report(recorded(bag), tmp_path / 'page.html')[0].read_text()
    assert '<h2>Oil and energy</h2>' in page and '<td>kfe</td>' in page
    assert 'its shares; rest: relief valves' in page    # no code of the line break of the text


def test_the_shares_close_to_a_ten_millionth(drop):
    """E1 to E9: the number of docs/bag.md and docs/equations.md, of every actuator and supply."""
    for name, account in drop.accounts.items():
        given, shares = (
            (account[PUMP.key] + account[HELD.key], SUPPLY_SHARES) if PUMP.key in account
            else (account[ENERGY.key], SHARES))
        values = [account[entry.key] for entry in shares]
        throughput = abs(given) + sum(map(abs, values))
        assert abs(given - sum(values)) < 1e-7 * throughput, name
