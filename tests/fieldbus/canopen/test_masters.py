"""Masters of `canopen` and of python-can drive a real actuator, each in processes of its own."""

from collections.abc import Callable, Iterator
import json
from pathlib import Path
import subprocess
import sys
from typing import Any

import pytest

NAMESPACE = ('unshare', '--map-root-user', '--net')
FAULT, STALL = 0x8611, 0.1     # following error; s
DEADLINE = 240.0               # s, kernels may have to be compiled first
Seen = Callable[[str], dict[str, Any]]
RUNS = {
    'base_node_402': ('base_node_402', 'udp_multicast', 0.0),
    'free': ('one_thread', 'udp_multicast', 0.0),
    'stalled': ('one_thread', 'udp_multicast', STALL),
    'socketcan': ('one_thread', 'socketcan', 0.0)}
"""Master, interface and longest stall."""


def refusal(*command: str) -> str:
    """Return why a command is refused in a network namespace, '' if it is not."""
    try:
        ended = subprocess.run([*NAMESPACE, *command], capture_output=True, text=True)
    except OSError as error:
        return str(error)
    return ended.stderr.strip() if ended.returncode else ''


@pytest.fixture(scope='module')
def refused() -> dict[str, str]:
    """Return why an interface is not there, by its name."""
    return {'udp_multicast': refusal('ip', 'link', 'set', 'lo', 'up'),
            'socketcan': refusal('ip', 'link', 'add', 'can0', 'type', 'vcan')}


@pytest.fixture(scope='module')
def seen(tmp_path_factory: pytest.TempPathFactory, refused: dict[str, str]) -> Iterator[Seen]:
    """Run each master in a namespace of its own, side by side; return what one saw."""
    children = {
        name: subprocess.Popen(
            [*NAMESPACE, sys.executable, '-m', 'tests.fieldbus.canopen.masters', master, interface,
             str(tmp_path_factory.mktemp(name)), str(stall)],
            stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parents[3])
        for name, (master, interface, stall) in RUNS.items() if not refused[interface]}
    results: dict[str, dict[str, Any]] = {}

    def result(name: str) -> dict[str, Any]:
        if name not in children:
            pytest.skip(f'no {RUNS[name][1]} here: {refused[RUNS[name][1]]}')
        if name not in results:
            output, _ = children[name].communicate(timeout=DEADLINE)
            results[name] = json.loads(output)
        return results[name]
    try:
        yield result
    finally:
        for child in children.values():
            if child.poll() is None:
                child.kill()
                child.wait()


def test_base_node_402_enables_a_real_actuator_by_its_eds(seen):
    result = seen('base_node_402')
    assert result['name'] == 'ram'
    assert result['enabled'] == 'OPERATION ENABLED'
    assert result['end'] == 'SWITCH ON DISABLED'
    assert result['heartbeat'] == 'OPERATIONAL'


def test_base_node_402_sees_a_fault_resets_it_and_enables_again(seen):
    result = seen('base_node_402')
    assert result['fault'] == 'FAULT'
    assert (result['code'], result['history']) == (FAULT, FAULT)
    assert result['register'] & 0x21 == 0x21        # generic, and of the profile
    assert result['emergencies'] == [FAULT, 0]
    assert result['after'] == ['OPERATION ENABLED', 0, 0]


@pytest.mark.parametrize('other', ['stalled', 'socketcan'])
def test_a_master_gets_the_same_bytes_free_stalled_and_on_another_bus(seen, other):
    expected, found = seen('free'), seen(other)
    assert expected['lost'] == 0
    assert expected['status'] == 0x27
    assert expected['ticks'] == 400
    assert found == expected
