"""`isa view`: a run or a bag by what is given, refusals in one line, ended by a signal."""

from http.client import HTTPConnection
import io
from pathlib import Path
import signal
import subprocess
import sys
import time

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.cli.main import main
from isa_ros.errors import BagError
from isa_ros.view import playing
import pytest
from tests.bag.golden import GOLDEN

_DEADLINE = 120.0


class Started:
    """A started `isa view`, with a page that takes frames."""

    def __init__(self, *arguments: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, '-m', 'isa_ros', 'view', *arguments], text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        assert self.process.stdout is not None
        self.address = self.process.stdout.readline().strip()
        _, _, self.host, self.token, _ = self.address.split('/')

    def __enter__(self) -> 'Started':
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.communicate()

    def page(self):
        """Return the frames as a page gets them."""
        connection = HTTPConnection(self.host, timeout=_DEADLINE)
        connection.request('GET', f'/{self.token}/frames')
        return connection.getresponse()

    def end(self) -> tuple[int, str, str]:
        """End it as Ctrl-C does; return exit code and output."""
        self.process.send_signal(signal.SIGINT)
        out, err = self.process.communicate(timeout=_DEADLINE)
        return self.process.returncode, out, err


def test_a_bag_plays_until_a_signal():
    with Started(str(GOLDEN / 'rotor_step')) as own:
        assert own.address.startswith('http://127.0.0.1:') and len(own.token) == 32
        page = own.page()
        assert page.status == 200 and page.readline().startswith(b'data: {"first":0,')
        assert own.end() == (0, '', '')
        page.read()     # the stream has an end


def test_a_terminal_sees_that_the_bag_is_read(monkeypatch, capsys):
    """A long one takes seconds before there is an address."""
    seen = []

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    def player(bag: Path, folder: Path) -> None:
        seen.append(sys.stderr.getvalue())
        raise BagError(f'{bag} has no end')
    monkeypatch.setattr(sys, 'stderr', Terminal())
    monkeypatch.setattr(playing, 'Player', player)
    assert main(['view', str(GOLDEN / 'rotor_step')]) == BagError.exit_code
    assert len(seen) == 1 and 'reading ' in seen[0]


def test_a_run_is_recorded_until_a_signal(tmp_path: Path):
    """Its bag is whole and named; the exit code is that of a bring-up that was stopped."""
    out = tmp_path / 'bag'
    with Started('rig_linear', '--out', str(out), '--real-time-factor', '20') as own:
        page, frames, end = own.page(), 0, time.monotonic() + _DEADLINE
        while frames < 5:
            frames += page.readline().startswith(b'data: ')
            assert time.monotonic() < end
        code, printed, said = own.end()
        assert (code, printed) == (130, f'{out}\n')
        assert said.splitlines()[-1].startswith('isa: stopped at t = ')
        assert b'"is_over":true' in page.read()
    assert Bag(out).is_whole and isa_ros.read(out).time[-1] > 0.05


def test_a_run_that_ends_ends_the_program(tmp_path: Path):
    with Started('rig_linear', '--out', str(tmp_path / 'bag'), '--duration', '0.2') as own:
        assert own.page().read().endswith(b'}\n\n')
        assert own.process.wait(_DEADLINE) == 0
    assert isa_ros.read(tmp_path / 'bag').time[-1] == 0.2


@pytest.mark.parametrize('arguments, message', [
    (['no_bag'], 'isa: no_bag: no such file; shipped: '),
    (['.'], 'isa: . holds 0 MCAP files'),
    ([str(GOLDEN / 'rotor_step'), '--seed', '3'], f'isa: --seed is not used: {GOLDEN}'),
    ([str(GOLDEN / 'rotor_step'), '--set', 'a=1'], 'isa: --set is not used: '),
    ([str(GOLDEN / 'rotor_step'), '--paused'], 'isa: --paused is not used: '),
    (['leg', '--scenario', 'fly'], 'isa: fly: no such file; shipped: '),
    (['leg', '--real-time-factor', '-1'], None), (['leg', '--port', '65536'], None),
    (['leg', '--port', '-1'], None), (['leg', '--in-process'], None)])
def test_what_does_not_fit_is_refused_in_one_line(arguments, message, capsys, tmp_path,
                                                  monkeypatch):
    monkeypatch.chdir(tmp_path)
    if message is None:     # by the parser
        with pytest.raises(SystemExit) as ended:
            main(['view', *arguments])
        assert ended.value.code == 2
    else:
        assert main(['view', *arguments]) == 2
    printed = capsys.readouterr()
    assert printed.out == '' and printed.err.count('\n') == 1
    assert printed.err.startswith(message or 'isa')
