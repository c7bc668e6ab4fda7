"""The words that may follow in a command line, read from the parsers."""

import argparse
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from isa_ros.config.paths import CONFIG, SCENARIOS, shipped

_SHIPPED = {'CONFIG': CONFIG, 'MODEL|CONFIG': CONFIG, '--scenario': SCENARIOS}
"""Folders of shipped files by the metavar of an argument, or by its flag."""


class Argument(NamedTuple):
    """One option; one positional argument has no flags."""

    flags: tuple[str, ...]
    meaning: str
    takes_value: bool
    values: tuple[str, ...]
    """Known words for its value; files may be given too, unless `is_closed`."""
    is_closed: bool


class CommandGrammar(NamedTuple):
    """One command by its path of words, `()` is `isa` itself; ``below``: summary by name."""

    path: tuple[str, ...]
    below: dict[str, str]
    arguments: tuple[Argument, ...]

    @property
    def options(self) -> list[Argument]:
        """Return the arguments with flags."""
        return [argument for argument in self.arguments if argument.flags]

    @property
    def first_words(self) -> list[str]:
        """Return the known words that are not flags: commands below, names of files."""
        return [*self.below, *(word for argument in self.arguments if not argument.flags
                               for word in argument.values)]


def commands_of(
        parser: argparse.ArgumentParser, path: tuple[str, ...] = ()) -> Iterator[CommandGrammar]:
    """Yield the command of a parser, then those below it, in their order."""
    rows, below = [], []
    summaries: dict[str, str] = {}
    for action in parser._actions:  # argparse has no public list of them
        if isinstance(action, argparse._SubParsersAction):
            summaries = {row.dest: _plain(row.help) for row in action._choices_actions}
            below = list(action.choices.items())
        else:
            rows.append(_argument(action))
    yield CommandGrammar(path, summaries, tuple(rows))
    for name, own in below:
        yield from commands_of(own, (*path, name))


def _argument(action: argparse.Action) -> Argument:
    choices: Sequence[Any] = tuple(action.choices or ())
    folder = _SHIPPED.get(str(action.metavar)) or next(
        (_SHIPPED[flag] for flag in action.option_strings if flag in _SHIPPED), None)
    values = tuple(map(str, choices)) or tuple(
        name.removesuffix('.yaml') for name in (shipped(folder) if folder else ()))
    return Argument(
        tuple(action.option_strings), _plain(action.help), action.nargs != 0, values,
        is_closed=bool(choices))


def _plain(text: str | None) -> str:
    """Return the text of a help: its defaults are of no use here."""
    return ' '.join((text or '').partition('(default')[0].replace('%%', '%').split())
