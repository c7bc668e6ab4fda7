"""`assert_reproduces` with an external body: made by its class, a factory, or its name."""

from pathlib import Path

import isa_ros
from isa_ros.cli.main import main
from isa_ros.errors import ConfigError
from isa_ros.testing import assert_reproduces
import pytest
from tests.replay.test_external import CONFIG, SCENARIO
from tests.surroundings.mass_on_spring import MassOnSpring

FACTORY = 'tests.surroundings.mass_on_spring:MassOnSpring'


class Heavier(MassOnSpring):
    """Its model says that it is another one; the spring, too, pulls a little more."""

    def __init__(self, mounting: isa_ros.Mounting) -> None:
        super().__init__(mounting)
        self.provenance = {'simulator': 'by hand 1.0', 'model_sha256': 'abc'}

    def motion(self, state, forces):
        """Return its motion under another force of the first actuator."""
        return super().motion(state, forces + [1e-3, 0.0])


@pytest.fixture(scope='module')
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with run file, scenario and bag; the run file names no class."""
    folder = tmp_path_factory.mktemp('crane')
    head, _, tail = CONFIG.partition(", class: 'tests.surroundings.mass_on_spring:Turned'")
    (folder / 'crane.yaml').write_text(head + tail)
    (folder / 'push.yaml').write_text(SCENARIO)
    isa_ros.load(folder / 'crane.yaml', folder / 'push.yaml').simulate(
        0.01, body=MassOnSpring).save(folder / 'bag')
    return folder


def reproduce(files: Path, bag: str = 'bag', **more: object) -> None:
    assert_reproduces(
        files / 'crane.yaml', files / 'push.yaml', files / bag, duration=0.01, **more)


@pytest.mark.parametrize('body', [MassOnSpring, FACTORY, {'body': FACTORY}])
def test_a_body_of_today_gives_the_bag(files: Path, body: object) -> None:
    reproduce(files, body=body)


def test_another_model_is_named_first(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Before the keys of the configuration, and then where it differs; `isa compare` as well."""
    with pytest.raises(AssertionError) as caught:
        assert_reproduces(
            files / 'crane.yaml', files / 'push.yaml', files / 'bag', body=Heavier)
    lines = [' '.join(line.split()) for line in str(caught.value).splitlines()]
    assert lines[2:5] == [
        'key in the bag now unit', 'body.body.model_sha256 absent abc',
        'scenario.duration_s 0.01 0.03']
    assert lines[5].startswith('scenario.tracks.out[1] absent {t_s: 0.01')   # after the bag's end
    assert lines[6].startswith('differ: tick 0 (t = 0.000000 s), /back/load_port, '), lines
    isa_ros.load(files / 'crane.yaml', files / 'push.yaml').simulate(
        0.01, body=Heavier).save(files / 'heavier')
    assert main(['compare', str(files / 'bag'), str(files / 'heavier')]) == 1
    assert capsys.readouterr().out.splitlines()[2].split()[0] == 'body.body.model_sha256'


@pytest.mark.parametrize(('body', 'message'), [
    (None, 'body is external and has no class'),
    ('crane', "^body = 'crane', must be module:factory"),
    ('no_such_crane:it', "^body = no_such_crane:it: No module named 'no_such_crane'"),
    ({'arm': FACTORY}, "'arm' is not a body of the kind external")])
def test_what_makes_no_body_is_refused(files: Path, body: object, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        reproduce(files, body=body)
