"""For which processors a call of the script makes libraries."""

import io

from isa_ros.core.objects import TARGETS
import pytest
from scripts import make_kernels
from scripts.make_kernels import main, Making


@pytest.mark.parametrize(('words', 'targets'), [
    ([], ['x86-64-v3']), (['--own'], ['x86-64-v3', 'x86-64']), (['aarch64'], ['aarch64']),
    (['--all'], ['x86-64-v3', 'x86-64', 'aarch64'])])
def test_the_targets_of_a_command_line(tmp_path, monkeypatch, words, targets):
    """By default the fastest of this machine; ``--own`` all that run on it."""
    class Nothing(Making):
        def run(self, processes):
            assert processes > 0 and self._objects.targets == tuple(targets)
    monkeypatch.setattr(make_kernels, 'Making', Nothing)
    monkeypatch.setattr(make_kernels, 'own_target', lambda: TARGETS['x86-64-v3'])
    monkeypatch.setattr(make_kernels, 'own_targets', lambda: ['x86-64-v3', 'x86-64'])
    monkeypatch.setattr(make_kernels, 'link', lambda target, *_: f'linked {target.name}')
    said = io.StringIO()
    assert main([*words, '--out', str(tmp_path)], said) == 0
    assert said.getvalue().splitlines() == [f'linked {name}' for name in targets]
