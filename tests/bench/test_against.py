"""This checkout against a revision: its files, the order of the runs, and the ratios."""

import subprocess
import sys

from isa_ros.bench import against, child
from isa_ros.bench.against import Cost, ratio_rows
from isa_ros.bench.spec import LEG, PROCESSES, Spec
from isa_ros.cli.main import main
from isa_ros.errors import ConfigError, RunError
import pytest
from tests.bench.packages import package_in

SPEC = Spec(LEG, PROCESSES, 10)


@pytest.fixture
def repository(tmp_path, monkeypatch):
    """Return a checkout with a commit of the word old, and new in its files."""
    root = tmp_path / 'checkout'
    root.mkdir()
    (root / 'word.txt').write_text('old')
    for arguments in (['init', '-q'], ['add', '.'], [
            '-c', 'user.name=a', '-c', 'user.email=a@b', 'commit', '-q', '-m', 'old']):
        subprocess.run(['git', '-C', str(root), *arguments], check=True)
    (root / 'word.txt').write_text('new')
    monkeypatch.setattr(against, 'ROOT', root)
    return root


def test_the_files_of_a_revision_are_set_aside(repository):
    with against.checkout('HEAD') as old:
        assert (old / 'word.txt').read_text() == 'old'
    assert not old.exists()
    assert (repository / 'word.txt').read_text() == 'new'


@pytest.mark.parametrize('revision', ['none', '--help', 'HEAD:word.txt'])
def test_what_is_not_a_revision_is_refused(repository, revision):
    with pytest.raises(ConfigError, match='^--against .*: no such revision$'):
        with against.checkout(revision):
            pass


def test_without_a_checkout_nothing_is_compared(tmp_path, monkeypatch):
    monkeypatch.setattr(against, 'ROOT', tmp_path)
    monkeypatch.setenv('GIT_CEILING_DIRECTORIES', str(tmp_path.parent))
    with pytest.raises(ConfigError, match='is not a checkout with git'):
        with against.checkout('HEAD'):
            pass


def test_the_group_needs_its_option(capsys):
    assert main(['bench', '--only', 'against']) == 2
    assert capsys.readouterr().err == (
        'isa: --only against: needs --against REV, a commit of this checkout\n')


def test_old_and_new_run_in_turn_and_the_first_of_each_is_not_counted(tmp_path, monkeypatch):
    """The ones that compile may take longer, and every other pair begins with the other."""
    order = []

    def cost_of(spec, root, timeout_s):
        order.append(('old' if root == tmp_path else 'new', timeout_s))
        return Cost(float(len(order)), 1.0 + len(order))
    monkeypatch.setattr(against, 'cost_of', cost_of)
    pairs = against.measured_pairs(SPEC, tmp_path)
    assert [name for name, _ in order] == ['old', 'new', 'new', 'old'] * 2
    assert [timeout for _, timeout in order] == 2 * [900.0] + 6 * [180.0]
    assert [(old.processor, new.processor) for old, new in pairs] == [
        (4.0, 3.0), (5.0, 6.0), (8.0, 7.0)]


def test_the_ratio_is_the_median_of_those_of_pairs():
    """Of 0.2, 0.5 and 0.25; of host time all are above the aim."""
    pairs = [(Cost(10e-6, 1e-6), Cost(2e-6, 1e-6)), (Cost(2e-6, 1e-6), Cost(1e-6, 2e-6)),
             (Cost(8e-6, 1e-6), Cost(2e-6, 3e-6))]
    processor, before, now, host, *_ = ratio_rows(SPEC, 'v1', pairs)
    assert (processor.lowest, processor.value, processor.highest) == pytest.approx(
        (0.2, 0.25, 0.5))
    assert processor.is_reached and not processor.note
    assert (before.name, before.value, now.value) == ('v1', pytest.approx(8.0), pytest.approx(2.0))
    assert before.part_of == processor.name == (
        'the leg, processes: processor time of a tick, over v1')
    assert host.value == pytest.approx(2.0) and host.is_reached is False
    assert host.note == '1.0 us before, 2.0 us now'


def test_a_run_is_that_of_the_files_it_is_given(tmp_path):
    """Its own module is found there first, and its values are read by two keys only."""
    package = package_in(tmp_path) / 'bench'
    package.mkdir()
    (package / '__init__.py').touch()
    (package / 'measure.py').write_text(
        'import json, sys\n'
        'json.dump({"processor": {"a": 3e-6, "b": 1e-6}, "ticks_per_s": 4000.0, "old": 1}, '
        'open(sys.argv[3], "w"))\n')
    assert against.cost_of(SPEC, tmp_path, 60.0) == Cost(pytest.approx(4e-6), 0.25e-3)
    (package / 'measure.py').write_text('raise SystemExit("no such plant")\n')
    with pytest.raises(RunError, match='^the leg, processes of .*: no such plant$'):
        against.cost_of(SPEC, tmp_path, 60.0)


def test_a_run_that_does_not_end_is_refused(tmp_path, monkeypatch):
    def never(*arguments):
        raise subprocess.TimeoutExpired('python', 5.0)
    monkeypatch.setattr(against, 'run_module', never)
    with pytest.raises(RunError, match='not finished after 5 s'):
        against.cost_of(SPEC, tmp_path, 5.0)


def test_a_module_of_another_root_comes_first(tmp_path):
    """Also where the process itself stands in a checkout."""
    (package_in(tmp_path) / 'where.py').write_text('print(__file__)\n')
    ended = child.run_module('isa_ros.where', [], 60.0, tmp_path)
    assert ended.stdout.strip() == str(tmp_path / 'isa_ros' / 'where.py'), ended.stderr
    assert sys.path[0] != str(tmp_path)
