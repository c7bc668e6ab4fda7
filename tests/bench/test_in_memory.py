"""The rows of the leg in memory: what is compared is what their names say."""

from typing import Any

from isa_ros.bench import in_memory
from isa_ros.bench.in_memory import every_level
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.conditions import CONDITIONS
from isa_ros.scripting.run import load
import pytest

_KEY = 'actuators.{}.parameters.reu.protection.{}'


def protections(run: RunConfig) -> list[Any]:
    return [own.sheet.reu.protection for own in run.actuators]


def test_with_every_level_no_condition_of_the_reu_is_off():
    run = load('leg', 'drop').replace({
        _KEY.format(joint, key): value for joint in ('haa', 'hfe', 'kfe')
        for key, value in every_level().items()}).scenario.run
    for own in protections(run):
        assert own.switch == 'on' and own.mask == 0.0 and own.setpoint_timeout_ms == 3.6e6
        levels = [getattr(own, each.name) for each in CONDITIONS if each.levels is not None]
        assert len(levels) == 16
        assert all(each.warning > 0.0 and each.trip > 0.0 for each in levels)
        assert 'none' not in [each.reaction for each in levels]


def test_it_adds_levels_and_changes_none():
    for shipped in protections(load('leg', 'drop').scenario.run):
        assert shipped.setpoint_timeout_ms == 0.0
        for key in every_level():
            name, _, level = key.partition('.')
            assert not level or getattr(getattr(shipped, name), level) == 0.0


def test_no_added_level_is_reached_in_the_drop():
    result = load('leg', 'drop').replace({
        _KEY.format(joint, key): value for joint in ('haa', 'hfe', 'kfe')
        for key, value in every_level().items()}).simulate(0.5)
    plain = load('leg', 'drop').simulate(0.5)
    for joint in ('haa', 'hfe', 'kfe'):
        for column in ('warnings', 'trips', 'force'):
            assert (result[f'{joint}.{column}'] == plain[f'{joint}.{column}']).all()


def test_with_and_without_are_run_in_turn(monkeypatch: pytest.MonkeyPatch):
    """The first round is left out; what takes a clock tick more than the other adds 100 %."""
    clock, order = [0.0], []

    def work(scenario: Any) -> Any:
        own = scenario.run.actuators[0].sheet.reu.protection
        is_on = own.switch == 'on'
        assert own.overload.trip == (0.96 if is_on else 0.0)

        def run() -> None:
            order.append(is_on)
            clock[0] += 2.0 if is_on else 1.0
        return run
    monkeypatch.setattr(in_memory, '_kernel_work', work)
    monkeypatch.setattr(in_memory.time, 'process_time', lambda: clock[0])
    assert in_memory._watching_percent({'overload.trip': 0.96}) == [100.0] * 21
    assert order == [True, False] * 22


def test_the_two_rows_of_the_protection_are_as_shipped_and_with_every_level(
        monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(in_memory, '_kernel_seconds', lambda drop: 5e-5)
    monkeypatch.setattr(in_memory, '_simulated', lambda simulation: 7e-5)
    monkeypatch.setattr(in_memory, '_added_seconds', lambda drop: 1e-5)
    monkeypatch.setattr(in_memory, '_sweep_rows', lambda: [])
    monkeypatch.setattr(
        in_memory, '_watching_percent', lambda levels: [1.5 + len(levels), 2.0, 1.0])
    shipped, every = in_memory.in_memory_rows()[1:3]
    assert (shipped.value, shipped.highest, shipped.aim) == (1.5, 2.0, None)
    assert (every.value, every.highest, str(every.aim)) == (2.0, 1.5 + len(every_level()), '<= 8')
