"""The command `isa bench`: select groups, measure them, and write the rows."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
import sys

from isa_ros.bench import page
from isa_ros.bench.groups import BenchGroup, groups, OnRequest
from isa_ros.bench.host import Machine, machine
from isa_ros.bench.page import as_lines, HEAD, PAGE, Report, Section
from isa_ros.bench.parts import misfits
from isa_ros.bench.rounds import Outcomes, outcomes
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, RunError
from isa_ros.text.json_file import write_tree
from isa_ros.text.page import refuse_a_part, write_wanted_page
from isa_ros.text.progress import counted, Progress


def chosen(
        only: Sequence[str] | None, wanted: OnRequest = OnRequest()) -> tuple[BenchGroup, ...]:
    """
    Return the groups named in ``only``, in their own order; for None all that can be measured.

    Those on request are among them if ``wanted``.

    Raises
    ------
    ConfigError
        A group does not exist, or cannot be measured here.

    """
    by_name = {group.name: group for group in groups(wanted)}
    for name in only or ():
        if name not in by_name:
            raise ConfigError(f'--only {name}: no such group; {alternatives(name, by_name)}')
        if reason := by_name[name].missing():
            raise ConfigError(f'--only {name}: {reason}')
    return tuple(group for name, group in by_name.items()
                 if (name in only if only else not group.missing()))


def bench(
        json_file: Path | None = None, only: Sequence[str] | None = None,
        out: Path | None = None, wanted: OnRequest = OnRequest()) -> Report:
    """
    Measure, print each row when it is ready, and write JSON or the page if requested.

    Raises
    ------
    ConfigError
        A group does not exist or cannot be measured here, or only a part of an existing page
        was measured.
    RunError
        A run could not be completed, or parts of a row do not add up to it; then no page is
        written.

    """
    measured = chosen(only, wanted)
    if out is not None:
        refuse_a_part(out / PAGE, only)
    here = machine()
    print(f'{here.summary}\n{HEAD}')
    if only is None:
        for group in groups(wanted):
            if reason := group.missing():
                print(f'{group.name}: not measured, {reason}')
    report = replace(measured_report(measured, here, counted(sys.stderr, 'runs')),
                     options=wanted.options)
    if json_file is not None:
        write_tree(page.as_tree(report), json_file)
    wrong = misfits(row for section in report.sections for row in section.rows)
    if wrong:
        raise RunError('; '.join(wrong))
    write_wanted_page(page, report, out)
    return report


def measured_report(
        groups: Sequence[BenchGroup], here: Machine, progress: Progress | None = None) -> Report:
    """Measure the groups without runs, then do all runs and evaluate the other groups."""
    sections: dict[str, Section] = {}
    done = Outcomes({})
    for has_runs in (False, True):
        below = [group for group in groups if bool(group.specs()) is has_runs]
        if has_runs:
            done = outcomes(list(dict.fromkeys(
                spec for group in below for spec in group.specs())), progress)
        for group in below:
            section = Section(
                group.name, group.title, tuple(group.rows(done)), group.drawing(done))
            print('\n'.join(as_lines(section)), flush=True)
            sections[group.name] = section
    return Report(here, tuple(sections[group.name] for group in groups), done)
