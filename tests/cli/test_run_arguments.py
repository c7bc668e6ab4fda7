"""The arguments of `isa bringup`."""

from pathlib import Path

from isa_ros.cli.main import make_parser
from isa_ros.config.paths import CONFIG, find
from isa_ros.run.options import Request, request_of_arguments


def asked(*arguments: str) -> Request:
    """Return the request of `isa bringup ARGUMENTS`."""
    return request_of_arguments(vars(make_parser().parse_args(['bringup', *arguments])))


def test_without_options_the_defaults_are_asked_for():
    assert asked('leg') == Request(config=find('leg', CONFIG))


def test_every_option_reaches_the_request(tmp_path):
    state = tmp_path / 'state.json'
    assert asked(
        'leg', '--scenario', 'drop', '--duration', '0.5', '--out', 'bag', '--overwrite',
        '--compression', 'zstd', '--split-mb', '0', '--real-time-factor', '2', '--in-process',
        '--elsewhere', 'haa,hfe', '--controller', 'sway', '--controller', 'hold',
        '--sync', '--join-timeout', '7', '--paused', '--restore', 'a.json', '--save', str(state),
        '--seed', '7'
    ) == Request(
        config=find('leg', CONFIG), scenario=find('drop', 'config/scenarios'), duration_s=0.5,
        out=Path('bag'), overwrite=True, compression='zstd', split_mb=0.0, real_time_factor=2.0,
        is_synced=True, in_process=True, elsewhere=('haa', 'hfe'), controllers=('sway', 'hold'),
        join_timeout_s=7.0, is_paused=True, restore=Path('a.json'), save=state,
        seed=7)


def test_one_call_leaves_nothing_to_the_next():
    assert asked('leg', '--controller', 'sway').controllers == ('sway',)
    assert asked('leg').controllers == ()
