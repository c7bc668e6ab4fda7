"""The options of the command."""

import sys

from isa_ros.bench import against, command, groups, rounds
from isa_ros.bench.command import chosen
from isa_ros.bench.groups import alone, BenchGroup, GROUPS, OnRequest
from isa_ros.bench.parts import divided
from isa_ros.bench.row import Row
from isa_ros.bench.spec import LEG, ONE_PROCESS, Spec
from isa_ros.cli.main import main
import pytest
from tests.bench.artificial import ran
from tests.text.terminal import Terminal


def test_groups_are_chosen_by_name_in_their_own_order():
    assert chosen(None)[:len(GROUPS)] == GROUPS
    assert [group.name for group in chosen(['tick', 'plant'])] == ['plant', 'tick']


def test_a_wrong_group_is_answered_with_the_right_one(capsys):
    assert main(['bench', '--only', 'peer']) == 2
    assert capsys.readouterr().err == (
        'isa: --only peer: no such group; did you mean peers?\n')


def test_without_a_checkout_the_groups_of_benchmarks_are_left_out(monkeypatch, tmp_path, capsys):
    assert {'growth', 'peers', 'bus'} <= {group.name for group in groups.groups()[len(GROUPS):]}
    monkeypatch.setattr(groups, 'CHECKOUT', tmp_path)
    assert chosen(None) == GROUPS
    for name in ('growth', 'peers', 'bus'):
        assert main(['bench', '--only', name]) == 2
        assert capsys.readouterr().err == (
            f'isa: --only {name}: needs a checkout of isa_ros: its folder benchmarks is not '
            'installed\n')


def test_a_group_that_cannot_be_measured_is_left_out_or_says_why(monkeypatch, capsys):
    absent = BenchGroup('bus', 'A bus', alone(list), missing=lambda: 'unshare is not installed')
    monkeypatch.setattr(command, 'groups', lambda wanted: (*GROUPS, absent))
    assert chosen(None) == GROUPS
    assert main(['bench', '--only', 'bus']) == 2
    assert capsys.readouterr().err == 'isa: --only bus: unshare is not installed\n'


def test_a_part_does_not_replace_the_page(tmp_path, capsys):
    (tmp_path / 'bench.md').write_text('the whole')
    assert main(['bench', '--only', 'plant', '--out', str(tmp_path)]) == 2
    assert 'bench.md already exists' in capsys.readouterr().err
    assert (tmp_path / 'bench.md').read_text() == 'the whole'


def test_rows_are_printed_and_written(monkeypatch, tmp_path, capsys):
    group = BenchGroup('own', 'A group', lambda _: [Row('a row', 2.0, 'us', 'floor', 0.5)])
    monkeypatch.setattr(command, 'chosen', lambda only, wanted: (group,))
    assert main(['bench', '--json', str(tmp_path / 'b.json'), '--out', str(tmp_path),
                 '--against', 'v1', '--first-run']) == 0
    assert '    ./isa bench --against v1 --first-run --out docs\n' in (
        tmp_path / 'bench.md').read_text()
    printed = capsys.readouterr().out
    assert 'A group (own)' in printed and 'a row' in printed and str(tmp_path) in printed
    assert (tmp_path / 'bench.md').exists() and (tmp_path / 'b.json').exists()


def test_parts_that_do_not_add_up_are_printed_and_refused(monkeypatch, tmp_path, capsys):
    """The JSON has them; a page is not written."""
    rows = divided(Row('a tick', 100.0, 'us'), {'kernels': 30e-6}, 0.2)
    group = BenchGroup('own', 'A group', lambda _: rows)
    monkeypatch.setattr(command, 'chosen', lambda only, wanted: (group,))
    assert main(['bench', '--json', str(tmp_path / 'b.json'), '--out', str(tmp_path)]) == 3
    ended = capsys.readouterr()
    assert 'of it not covered' in ended.out
    assert ended.err.endswith('a tick: of it not covered 70 us, +70% of a tick, '
                              'must be within 20%\n')
    assert (tmp_path / 'b.json').exists() and not (tmp_path / 'bench.md').exists()


@pytest.mark.parametrize('option', ['--json', '--out'])
def test_a_place_that_cannot_be_written_is_refused_before_anything(option, tmp_path, capsys):
    (tmp_path / 'file').write_text('')
    with pytest.raises(SystemExit) as ended:
        main(['bench', option, str(tmp_path / 'file' / 'below')])
    assert ended.value.code == 2


def test_a_terminal_shows_the_next_run_and_nothing_is_left_at_the_end(monkeypatch):
    spec = Spec(LEG, ONE_PROCESS, 10, rounds=2)
    group = BenchGroup('own', 'A group', lambda _: [], lambda: (spec,))
    monkeypatch.setattr(command, 'chosen', lambda only, wanted: (group,))
    monkeypatch.setattr(rounds, 'measured', lambda spec: ran(1000.0))
    monkeypatch.setattr(sys, 'stderr', Terminal())
    assert main(['bench']) == 0
    assert sys.stderr.getvalue() == (
        f'\r0 of 2 runs, 0 s: {spec}\x1b[K\r1 of 2 runs, 0 s, 0 s left: {spec}\x1b[K\r\x1b[K')


def test_groups_on_request_are_measured_with_their_options_only(monkeypatch):
    assert [group.name for group in chosen(None, OnRequest('HEAD', True))[len(GROUPS):]][:2] == [
        'against', 'first_run']
    assert 'against' not in {group.name for group in chosen(None)}
    asked = []
    monkeypatch.setattr(against, 'against_rows', lambda revision: asked.append(revision) or [])
    group, = chosen(['against'], OnRequest('v1'))
    assert group.rows({}) == [] and asked == ['v1'] and 'v1' in group.title


def test_without_them_one_line_says_what_they_need(monkeypatch, capsys):
    monkeypatch.setattr(command, 'chosen', lambda only, wanted: ())
    assert main(['bench']) == 0
    lines = capsys.readouterr().out.splitlines()
    assert 'against: not measured, needs --against REV, a commit of this checkout' in lines
    assert any(line.startswith('first_run: not measured, needs --first-run') for line in lines)
