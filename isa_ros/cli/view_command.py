"""`isa view`: a run or a bag in a browser; modules are imported as in `commands`."""

import argparse
from argparse import Namespace
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
import sys
from typing import Any

from isa_ros.cli import shared_arguments
from isa_ros.cli.run_arguments import run_options
from isa_ros.cli.running import recorded, simulating
from isa_ros.config.paths import CONFIG, find
from isa_ros.errors import ConfigError, one_line
from isa_ros.run.options import OPTION_OF, request_of_arguments
from isa_ros.text.progress import underway

_OPTIONS = [OPTION_OF[name] for name in (
    'scenario_file', 'set', 'seed', 'start_time', 'duration', 'out', 'overwrite', 'compression',
    'split_mb', 'sync', 'real_time_factor', 'fail_on_trip', 'paused', 'restore', 'save')]
_SPEED = 1.0
_OTHER_WORDS: Mapping[str, Mapping[str, Any]] = {
    'real_time_factor': {
        'meaning': 'speed at the start, 0: as fast as possible', 'otherwise': '1, real time'},
    'paused': {'meaning': 'begin paused, at t = 0'}}


def arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa view`."""
    parser.add_argument(
        'config', metavar='CONFIG|BAG',
        help='a run file, or a shipped one by name; or a recorded bag, to play it')
    parser.add_argument(
        '--port', type=shared_arguments.port, default=0, metavar='N',
        help='port of the page on this host (default: any that is free)')
    run_options(parser, [replace(own, **_OTHER_WORDS.get(own.name, {})) for own in _OPTIONS])
    parser.epilog = (
        'A run begins when the first page is open, and ends at its end or at Ctrl-C; the other '
        'options are those of a run. Nothing but this host can open the page.')


def view(options: Namespace) -> bool:
    """Show a run while it goes on, or play a bag."""
    path = Path(options.config)
    if path.is_dir() or path.suffix == '.mcap':
        for option in _OPTIONS:
            if getattr(options, option.name) not in (option.default, [], False):
                raise ConfigError(
                    f'--{option.name.replace("_", "-")} is not used: {path} is a bag')
        return _play(path, options.port)
    return _run(options)


def _tell(address: str) -> None:
    print(address, flush=True)


def _play(bag: Path, port: int) -> bool:
    from isa_ros.processes.stopping import StopRequest
    from isa_ros.view.playing import Player
    from isa_ros.view.server import serving
    with underway(sys.stderr, one_line(f'reading {bag}')):
        player = Player(bag, Path())
    with StopRequest() as should_stop, serving(player.hub, port) as address:
        _tell(address)
        player.play(should_stop)
    return True


@simulating
def _run(options: Namespace) -> bool:
    from isa_ros.processes.stopping import StopRequest
    from isa_ros.run.session import prepare, Report
    from isa_ros.view.running import view_run
    if options.real_time_factor is None:
        options.real_time_factor = _SPEED
    session = prepare(request_of_arguments(vars(options), is_alone=options.is_alone))
    folder = find(options.config, CONFIG).parent

    def run(report: Report | None) -> None:
        with StopRequest() as should_stop:
            view_run(session, options.port, folder, _tell, report, should_stop)
    recorded(session, run)
    return session.is_as_wanted
