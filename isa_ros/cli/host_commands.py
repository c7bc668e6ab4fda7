"""Commands about this host and its shell; modules are imported in them, as in `commands`."""

from argparse import Namespace


def completion(options: Namespace) -> bool:
    """Print the script that completes `isa` in a shell."""
    from isa_ros.cli.completion.grammar import commands_of
    from isa_ros.cli.completion.scripts import script_of
    from isa_ros.cli.main import make_parser
    print(script_of(options.shell, list(commands_of(make_parser()))), end='')
    return True
