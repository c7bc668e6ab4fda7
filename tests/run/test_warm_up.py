"""The kernels of a run from the cache."""

import signal
import subprocess
import sys

from isa_ros.config.paths import CONFIG, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.kernel import KernelEntry
from isa_ros.run import warm_up
import pytest

LEG = load_run(shipped(CONFIG)['leg.yaml'])
SURROUNDINGS = """
from isa_ros.core.bound import Bound
from isa_ros.run.warm_up import compile_surroundings
made, begin = set(), Bound.__init__
def note(self, function, memory):
    made.add(f'{function.__module__.rpartition(".")[2]}.{function.__name__}')
    begin(self, function, memory)
Bound.__init__ = note
compile_surroundings()
from isa_ros.actuator.ticking import tick_kernel
print(tick_kernel().compiled.signatures, *sorted(made))
"""


def test_another_process_compiles_the_surroundings_without_the_actuators() -> None:
    done = subprocess.run([sys.executable, '-c', SURROUNDINGS], input=LEG.to_yaml(),
                          capture_output=True, text=True, timeout=300.0)
    assert (done.stdout, done.stderr) == (
        '[] stepping.advance stepping.fill_ports stepping.show supply_tick.advance '
        'supply_tick.fill_pressures\n', '')


@pytest.mark.parametrize('other', [None, 'raise SystemExit(1)'])
def test_a_first_start_compiles_by_two_processes(
        monkeypatch: pytest.MonkeyPatch, other: str | None) -> None:
    """If the other one fails, this one compiles all."""
    began = []
    with monkeypatch.context() as patch:
        patch.setattr(KernelEntry, 'is_kept', lambda entry: False)
        patch.setattr(warm_up.os, 'sched_getaffinity', lambda _: {0, 1})
        if other is not None:
            patch.setattr(warm_up, '_OTHER', [sys.executable, '-c', other])

        class Began(subprocess.Popen[str]):
            def __init__(self, *arguments: object, **options: object) -> None:
                super().__init__(*arguments, **options)  # type: ignore[call-overload]
                began.append(self)

        patch.setattr(warm_up.subprocess, 'Popen', Began)
        by_two = warm_up.warmed_up(LEG)
    one, = began
    assert one.returncode == (0 if other is None else 1)
    assert [each.snapshot() for each in by_two] == [
        each.snapshot() for each in warm_up.warmed_up(LEG)]


@pytest.mark.parametrize('why', ['kept', 'one core', 'no body'])
def test_another_process_starts_only_if_it_helps(
        monkeypatch: pytest.MonkeyPatch, why: str) -> None:
    monkeypatch.setattr(KernelEntry, 'is_kept', lambda entry: why == 'kept')
    monkeypatch.setattr(
        warm_up.os, 'sched_getaffinity', lambda _: {0} if why == 'one core' else {0, 1})
    monkeypatch.setattr(warm_up, '_compile_by_two', lambda _: pytest.fail('a process started'))
    warm_up.warmed_up(load_run(shipped(CONFIG)['rig_rotary.yaml']) if why == 'no body' else LEG)


def test_an_interrupt_ends_the_other_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(warm_up, '_OTHER', ['sleep', '300'])
    with pytest.raises(KeyboardInterrupt), warm_up._other_process('') as other:
        raise KeyboardInterrupt
    assert other.returncode == -signal.SIGKILL
