"""Commands about this host and its shell; modules are imported in them, as in `commands`."""

from argparse import Namespace


def completion(options: Namespace) -> bool:
    """Print the script that completes `isa` in a shell."""
    from isa_ros.cli.completion.grammar import commands_of
    from isa_ros.cli.completion.scripts import script_of
    from isa_ros.cli.main import make_parser
    print(script_of(options.shell, list(commands_of(make_parser()))), end='')
    return True


def doctor(options: Namespace) -> bool:
    """Print what this host has for isa_ros; return whether nothing keeps runs from working."""
    from isa_ros.cli.doctor.finding import as_text, as_tree, is_healthy
    from isa_ros.cli.doctor.kernels import kernels
    from isa_ros.cli.doctor.limits import limits
    from isa_ros.cli.doctor.middleware import middleware
    from isa_ros.cli.doctor.software import software
    from isa_ros.text.json_file import write_tree
    findings = [*software(), *middleware(), *limits(), *kernels()]
    print(as_text(findings))
    if options.json:
        write_tree(as_tree(findings), options.json)
    return is_healthy(findings)
