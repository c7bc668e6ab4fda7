"""`isa view`: a bag in a browser; modules are imported as in `commands`."""

import argparse
from argparse import Namespace
from pathlib import Path

from isa_ros.cli import shared_arguments


def arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa view`."""
    shared_arguments.bag(parser)
    parser.add_argument(
        '--port', type=shared_arguments.port, default=0, metavar='N',
        help='port of the page on this host (default: any that is free)')
    parser.epilog = 'Ends at Ctrl-C. Nothing but this host can open the page.'


def view(options: Namespace) -> bool:
    """Play a bag on a page, until a signal ends it."""
    from isa_ros.processes.stopping import StopRequest
    from isa_ros.view.playing import Player
    from isa_ros.view.server import serving
    player = Player(options.bag, Path())
    with StopRequest() as should_stop, serving(player.hub, options.port) as address:
        print(address, flush=True)
        player.play(should_stop)
    return True
