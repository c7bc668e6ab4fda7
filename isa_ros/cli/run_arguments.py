"""Arguments made from the options of a run: those of `isa bringup`, and of `isa bus`."""

import argparse
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from isa_ros.cli import shared_arguments
from isa_ros.cli.argument_types import file_to_write, names, not_negative, positive, seed
from isa_ros.run.option import COMPRESSIONS, Kind, Option
from isa_ros.run.options import OPTIONS

_TYPES: Mapping[Kind, Callable[[str], Any]] = {
    Kind.PATH: Path, Kind.NEW_FILE: file_to_write, Kind.POSITIVE: positive,
    Kind.NOT_NEGATIVE: not_negative, Kind.WHOLE: seed, Kind.NAMES: names}
"""Checks of a value by kind; other kinds are texts."""


def bringup(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `isa bringup`."""
    run_options(parser, OPTIONS)


def run_options(parser: argparse.ArgumentParser, options: Sequence[Option]) -> None:
    """Add options of a run, where they are for the command line."""
    for option in options:
        if option.is_argument:
            _add(parser, option)


def _add(parser: argparse.ArgumentParser, option: Option) -> None:
    how: dict[str, Any] = {'help': option.argument_help}
    flag = f'--{option.name.replace("_", "-")}'
    if option.is_required:
        parser.add_argument(option.name, metavar=option.metavar, **how)
    elif option.kind is Kind.FLAG:
        parser.add_argument(flag, action='store_true', **how)
    elif option.kind is Kind.COMPRESSION:
        parser.add_argument(flag, choices=COMPRESSIONS, **how)
    elif option.kind is Kind.CHANGES:
        shared_arguments.changes(parser, option.argument_help)
    elif option.kind is Kind.REPEATED:
        parser.add_argument(
            flag, dest=option.name, action='append', default=[], metavar=option.metavar, **how)
    else:
        parser.add_argument(flag, type=_TYPES.get(option.kind, str), default=option.default,
                            metavar=option.metavar, **how)
