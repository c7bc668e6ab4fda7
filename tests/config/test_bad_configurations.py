"""Every file in config/bad must give the error of its first line, through the command line."""

from pathlib import Path

from isa_ros.cli.main import main
import pytest

BAD = sorted((Path(__file__).parents[2] / 'config' / 'bad').glob('*.yaml'))


def test_there_are_bad_configurations() -> None:
    assert len(BAD) >= 20


@pytest.mark.parametrize('path', BAD, ids=lambda path: path.stem)
def test_a_bad_configuration_gives_its_error(
        path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 2, one line with the file and the expected text, and nothing written."""
    first = path.read_text(encoding='utf-8').splitlines()[0]
    assert first.startswith('# error: ')
    out = tmp_path / 'out'
    assert main(['bringup', str(path), '--duration', '0.01', '--out', str(out)]) == 2
    printed = capsys.readouterr()
    assert first.removeprefix('# error: ') in printed.err
    assert path.name in printed.err
    assert printed.err.count('\n') == 1
    assert not printed.out and not out.exists()
