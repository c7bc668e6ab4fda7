"""The end of a program: one line, and the exit code of its cause."""

import errno
from pathlib import Path
import subprocess
import sys
from xml.etree import ElementTree

from isa_ros.errors import ConfigError, one_line, SimulationDiverged
from isa_ros.processes.ending import DEBUG_VARIABLE, end_of, REPORT_TO
import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize('error, code, text', [
    (ConfigError('leg.yaml: no'), 2, 'leg.yaml: no'),
    (SimulationDiverged(1_000_000, 'spool', float('nan')), 4, 'spool = nan'),
    (KeyboardInterrupt(), 130, 'interrupted'),
    (PermissionError(errno.EACCES, 'Permission denied', 'out'), 2, 'out: Permission denied'),
    (OSError(errno.ENOSPC, 'No space left on device', 'out'), 3, 'out: No space left on device'),
    (MemoryError(), 3, 'not enough memory'),
    (OSError(errno.ENOMEM, 'Cannot allocate memory'), 3, 'not enough memory'),
    (OSError(errno.ENOMEM, 'Nicht genug Speicher'), 3, 'not enough memory'),
    (ImportError('x.so: failed to map segment from shared object'), 3, 'not enough memory'),
    (RuntimeError("can't start new thread"), 3, 'not enough memory'),
    (RuntimeError('pthread_create failed: Resource temporarily unavailable'), 3,
     'not enough memory'),
    (ModuleNotFoundError("No module named 'rclpy'", name='rclpy'), 2, 'package rclpy is missing'),
    (ModuleNotFoundError("No module named 'isa_ros.x'", name='isa_ros.x'), 70, 'a defect'),
    (KeyError('none'), 70, "a defect of isa_ros, KeyError: 'none'"),
    (RecursionError('deep'), 70, 'a defect of isa_ros, RecursionError'),
])
def test_every_error_is_one_line_and_its_code(
        error: BaseException, code: int, text: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Never 1: that means that the answer is no."""
    assert end_of('isa', error) == code
    printed = capsys.readouterr().err
    assert printed.startswith('isa: ') and text in printed
    assert printed.count('\n') == 1


def test_the_line_of_a_defect_says_where_it_is_and_where_to_report_it(
        capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(AttributeError) as caught:
        one_line(None)  # type: ignore[arg-type]
    assert end_of('coordinator', caught.value) == 70
    line = capsys.readouterr().err
    assert '(isa_ros/errors.py:' in line
    assert f'please report this line to {REPORT_TO}' in line


def test_a_text_of_a_file_cannot_steer_the_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    assert end_of('actuator', ConfigError('a\x1b[2Jb\nc')) == 2
    assert capsys.readouterr().err == 'actuator: a\\x1b[2Jb\\nc\n'


def test_debug_shows_the_traceback_of_a_defect(
        monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(AttributeError) as caught:
        one_line(None)  # type: ignore[arg-type]
    monkeypatch.setenv(DEBUG_VARIABLE, '1')
    assert end_of('isa', caught.value) == 70
    printed = capsys.readouterr().err
    assert printed.startswith('Traceback') and 'in one_line' in printed
    assert printed.splitlines()[-1].startswith('isa: a defect of isa_ros, AttributeError')


def test_defects_are_reported_to_the_maintainer() -> None:
    maintainer = ElementTree.parse(ROOT / 'package.xml').find('maintainer')
    assert maintainer is not None
    assert REPORT_TO == f'{maintainer.text} <{maintainer.get("email")}>'
    setup = (ROOT / 'setup.py').read_text()
    assert f"maintainer='{maintainer.text}'" in setup
    assert f"maintainer_email='{maintainer.get('email')}'" in setup


@pytest.mark.parametrize(('load', 'printed'), [
    ('lambda: print(gc.isenabled()) or run', 'False\nTrue True\n3\n'),
    ('lambda: {}["none"]', '70\n')])
def test_nothing_is_collected_while_a_program_is_loaded(load: str, printed: str) -> None:
    done = subprocess.run([sys.executable, '-c', f"""
import gc
from isa_ros.processes.ending import run_program
def run():
    print(gc.isenabled(), gc.get_freeze_count() > 0)
    return 3
print(run_program('isa', {load}))
assert gc.isenabled()
"""], capture_output=True, text=True, timeout=60.0)
    assert done.stdout == printed
