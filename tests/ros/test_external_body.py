"""An external body in a run with a process for each actuator: silent, and broken."""

from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.cli.main import main
from isa_ros.replay.replay import replay
import pytest
from tests.replay.test_external import CONFIG
from tests.ros.breaking_body import WAITS_FOR
from tests.ros.started import bringup, wait_for

pytestmark = [pytest.mark.ros, pytest.mark.slow]
BROKEN = ('body.port_a0[1] (out) = nan at t = 0.005000 s, must be finite: the simulation '
          'diverged')


def test_a_body_is_named_when_it_is_silent_and_when_it_breaks(
        domain: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    """
    Not the coordinator, and not the actuator that gets its port; the bag replays and says why.

    `Breaking` refuses to be made twice in a process.
    """
    file, bag = tmp_path / 'go', tmp_path / 'bag'
    monkeypatch.setenv(WAITS_FOR, str(file))
    config = tmp_path / 'spring.yaml'
    config.write_text(CONFIG.replace('surroundings.mass_on_spring:Turned',
                                     'ros.breaking_body:Breaking'))
    with bringup(bag, '--duration', '0.02', config=config) as run:
        wait_for(lambda: "sent nothing for 5 s, or still computes body 'body', after 3 ticks"
                 in run.errors or not run.is_running(), 'the warning')
        file.touch()
        assert run.exit_code() == 4, run.errors
        assert f'isa: {BROKEN}' in run.errors
        assert 'out: no answer' not in run.errors and 'Wire' not in run.errors
    assert replay(Bag(bag)).is_equal
    assert main(['report', str(bag)]) == 0
    assert f'\n\nThe run ended by an error: {BROKEN}.\n' in capsys.readouterr().out
    assert '<li class="bad">The run ended by an error: ' in (bag / 'report.html').read_text()
