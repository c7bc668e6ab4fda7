"""`isa study`: list the studies, or run them, print, write and draw."""

from argparse import Namespace
from collections.abc import Mapping, Sequence
from dataclasses import replace
import sys
from typing import Any

from isa_ros.analysis.studies import (
    falling_load, hysteresis, lowering, page, power_unit, servo_valve, temperature)
from isa_ros.analysis.studies.measure import Benches, results, Studied
from isa_ros.analysis.studies.own_study import OwnStudy
from isa_ros.analysis.studies.studies import only_model, STUDIES, Study, study_of
from isa_ros.errors import ConfigError
from isa_ros.text.json_file import write_wanted
from isa_ros.text.page import write_wanted_page
from isa_ros.text.progress import counted
from isa_ros.text.table import aligned


def study(options: Namespace) -> None:
    """
    Run what is asked for, or list what there is.

    Raises
    ------
    ConfigError
        There is no such study or model, or options that do not go together.

    """
    if options.name in _OWN:
        _own(options, _OWN[options.name])
        return
    chosen = _chosen(options)
    if not chosen:
        print(listing())
        return
    benches = Benches()
    done: list[tuple[Study, Sequence[Studied]]] = []
    for one in chosen:
        found = results(one, benches, counted(sys.stderr, 'values', of=one.name))
        done.append((one, found))
        print(page.as_text(one, found), end='\n\n' if one is not chosen[-1] else '\n', flush=True)
    write_wanted([page.as_tree(*one) for one in done], options.json)
    write_wanted_page(page, done, options.out)


_OWN: Mapping[str, OwnStudy[Any]] = {module.STUDY.name: module.STUDY for module in (
    temperature, servo_valve, hysteresis, falling_load, lowering, power_unit)}


def _own(options: Namespace, own: OwnStudy[Any]) -> None:
    """Run a study that has a rig and a page of its own."""
    for option in ('model', 'values', 'all'):
        if getattr(options, option):
            raise ConfigError(f'--{option} is not used by the study {own.name}')
    found = own.results(counted(sys.stderr, 'values', of=own.name))
    print(own.as_text(found), flush=True)
    write_wanted(own.as_tree(found), options.json)
    write_wanted_page(own, found, options.out)


def listing() -> str:
    """Return every study, a line each."""
    return '\n'.join(aligned([
        *((one.name, one.title) for one in STUDIES),
        *((own.name, own.title) for own in _OWN.values())]))


def _chosen(options: Namespace) -> tuple[Study, ...]:
    if options.name is None and not options.all:
        for option in ('model', 'values', 'json', 'out'):
            if getattr(options, option) is not None:
                raise ConfigError(
                    f'--{option} needs a study, or --all; {", ".join(s.name for s in STUDIES)}')
        return ()
    if options.name is not None and options.all:
        raise ConfigError(f'study {options.name} and --all, must be one of both')
    asked = STUDIES if options.all else (study_of(options.name),)
    chosen = tuple(only_model(one, options.model) for one in asked)
    if options.values is None:
        return chosen
    if len(chosen) != 1 or len(chosen[0].cases) != 1:
        raise ConfigError('--values needs one study of one --model: units differ')
    case = replace(chosen[0].cases[0], values=tuple(options.values))
    return (replace(chosen[0], cases=(case,)),)
