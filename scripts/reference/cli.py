"""The commands of `isa`, from their parsers."""

import argparse

from isa_ros.cli.main import make_parser
from scripts.reference.markup import code, escaped, page, table

_HEAD = """\
Every command has `--help`. Exit codes are on [a page of their own](exit_codes.md). Where a name
is wrong, the message has the nearest right ones."""


def cli_page() -> str:
    """Return the page."""
    parser = make_parser()
    parts = []
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            helps = {own.dest: own.help or '' for own in action._choices_actions}
            parts += [_command(f'{parser.prog} {name}', own, helps.get(name, ''))
                      for name, own in action.choices.items()]
    return page('Commands', _HEAD, _arguments(parser), *parts)


def _command(name: str, parser: argparse.ArgumentParser, meaning: str, level: int = 2) -> str:
    """Return the section of a command, with those of its own commands below."""
    head = f'{"#" * level} {name}\n\n{escaped(parser.description or meaning).capitalize()}.'
    nested = [
        _command(f'{name} {own}', sub, '', level + 1)
        for action in parser._actions if isinstance(action, argparse._SubParsersAction)
        for own, sub in action.choices.items()]
    return '\n\n'.join(filter(None, [head, _arguments(parser), *nested]))


def _arguments(parser: argparse.ArgumentParser) -> str:
    rows = [[', '.join(map(code, _forms(parser, action))), escaped(_meaning(parser, action))]
            for action in parser._actions if action.help is not argparse.SUPPRESS
            and not isinstance(action, (argparse._SubParsersAction, argparse._HelpAction))
            and action.dest != 'debug']
    return table(['argument', 'meaning'], rows) if rows else ''


def _forms(parser: argparse.ArgumentParser, action: argparse.Action) -> list[str]:
    """Return how an argument is written."""
    formatter = parser.formatter_class(parser.prog)
    if not action.option_strings:
        return [formatter._format_args(action, formatter._get_default_metavar_for_positional(
            action)).replace('...', '').strip()]
    values = '' if action.nargs == 0 else ' ' + formatter._format_args(
        action, formatter._get_default_metavar_for_optional(action))
    return [f'{option}{values}' for option in action.option_strings]


def _meaning(parser: argparse.ArgumentParser, action: argparse.Action) -> str:
    if action.help:
        return parser.formatter_class(parser.prog)._expand_help(action)
    return 'one of ' + ', '.join(map(str, action.choices)) if action.choices else ''
