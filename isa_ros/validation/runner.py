"""Run groups of checks in two worker processes and gather what they found."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, IsaError
from isa_ros.text.page import png
from isa_ros.text.progress import Progress
from isa_ros.validation.entry import CheckGroup, Entry, Observation
from isa_ros.validation.workers import in_workers


@frozen
class Picture:
    """A drawn figure: PNG."""

    name: str
    caption: str
    png: bytes


@frozen
class GroupResult:
    """The result of a group, as a worker process returns it."""

    group: str
    title: str
    entries: tuple[Entry, ...]
    pictures: tuple[Picture, ...]
    observations: tuple[Observation, ...] = ()


class GroupFailed(IsaError):
    """A group that could not be run to its end; exit code as what ended it."""

    def __init__(self, message: str, exit_code: int) -> None:
        super().__init__(message, exit_code)  # both, so that it crosses from a worker
        self.exit_code = exit_code

    def __str__(self) -> str:
        """Return the message alone."""
        return str(self.args[0])


def chosen(groups: Sequence[CheckGroup], only: Sequence[str] | None) -> tuple[CheckGroup, ...]:
    """
    Return the groups that ``only`` names, as GROUP or as GROUP.ENTRY; all for None.

    Raises
    ------
    ConfigError
        There is no such group.

    """
    if not only:
        return tuple(groups)
    names = [group.name for group in groups]
    wanted = {name.partition('.')[0]: name for name in only}
    for group, name in wanted.items():
        if group not in names:
            raise ConfigError(f'--only {name}: no such group; {alternatives(group, names)}')
    return tuple(group for group in groups if group.name in wanted)


def validated(
        groups: Sequence[CheckGroup], only: Sequence[str] | None = None,
        progress: Progress | None = None) -> tuple[GroupResult, ...]:
    """
    Run the groups and return their results in order, of the entries ``only`` names.

    Raises
    ------
    ConfigError
        A group has no entry of a name in ``only``.
    GroupFailed
        A group cannot be run, or its simulation diverged.
    RunError
        A worker process was lost.

    """
    order = sorted(groups, key=lambda group: not group.is_long)
    results = {result.group: result for result in in_workers(
        [partial(run_group, group) for group in order], progress)}
    return tuple(only_of(results[group.name], only or ()) for group in groups)


def run_group(group: CheckGroup) -> GroupResult:
    """
    Run one group in this process and draw its figures.

    Raises
    ------
    GroupFailed
        It was refused or diverged.

    """
    try:
        findings = group.check()
    except IsaError as error:
        raise GroupFailed(f'{group.name}: {error}', error.exit_code) from error
    names = [entry.key for entry in findings.entries]
    if len(set(names)) != len(names):
        raise ValueError(f'{group.name}: two entries have the same name: {names}')
    return GroupResult(group.name, group.title, findings.entries, tuple(
        Picture(drawing.name, drawing.caption, png(drawing.titled()))
        for drawing in findings.drawings), findings.observations)


def only_of(result: GroupResult, only: Sequence[str]) -> GroupResult:
    """
    Return a result with the entries that ``only`` names; all where it names the group.

    An entry that is measured with several sets of gains is named with or without them.
    """
    mine = [name for name in only if name.partition('.')[0] == result.group]
    if not mine or result.group in mine:
        return result
    names = [{f'{result.group}.{entry.key}', f'{result.group}.{entry.name}'}
             for entry in result.entries]
    for name in mine:
        known = sorted(set().union(*names))
        if name not in known:
            raise ConfigError(f'--only {name}: no such entry; {alternatives(name, known)}')
    return replace(result, entries=tuple(
        entry for entry, own in zip(result.entries, names) if own.intersection(mine)),
        observations=())


def is_reached(results: Sequence[GroupResult]) -> bool:
    """Tell whether every entry is reached."""
    return all(entry.is_reached for result in results for entry in result.entries)
