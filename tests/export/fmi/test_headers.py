"""The shims declare the functions and types of the standard's headers, which fmpy ships."""

from importlib.resources import files
from pathlib import Path
import re
import shutil
import subprocess

import pytest

fmpy = pytest.importorskip('fmpy')

HEADERS = Path(fmpy.__file__).parent / 'c-code'
_TYPES = re.compile(
    r'^typedef (?:struct \{\n.*?\n\}[^;]*;|.*?;)\n', re.MULTILINE | re.DOTALL)


def shim(version: int) -> str:
    return (files('isa_ros.export.fmi') / 'sources' / f'fmi{version}.c').read_text()


@pytest.mark.parametrize('version', [2, 3])
def test_every_function_has_the_type_of_the_standard(version, tmp_path):
    """Without the types of their own the shims compile with those of the headers."""
    if not shutil.which('cc'):
        pytest.skip('no C compiler')
    text = shim(version)
    own = '\n'.join(_TYPES.findall(text))
    assert f'fmi{version}Status;' in own
    rest = _TYPES.sub('', text).replace(
        '#include "unit.h"', f'#include "unit.h"\n#include "fmi{version}Functions.h"')
    (tmp_path / 'shim.c').write_text(rest)
    sources = files('isa_ros.export.fmi') / 'sources'
    done = subprocess.run(
        ['cc', '-std=c11', '-Wall', '-Wextra', '-Werror', '-Wno-unused-parameter', '-c',
         f'-I{sources}', f'-I{HEADERS}', 'shim.c'],
        cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize('version', [2, 3])
def test_every_function_of_co_simulation_is_there(version):
    declared = set(re.findall(rf'(?<=TYPE)\s+(fmi{version}\w+);',
                              (HEADERS / f'fmi{version}Functions.h').read_text()))
    text = shim(version)
    defined = set(re.findall(rf'EXPORT .*?\b(fmi{version}\w+)\(', text))
    for macro, names in (('WHOLE', ('Get', 'Set')), ('NO_VARIABLE', ('Get', 'Set')),
                         ('NO_FUNCTION', ('',))):
        for name in re.findall(rf'^{macro}\((\w+)', text, re.MULTILINE):
            defined |= {f'fmi{version}{verb}{name}' for verb in names}
    of_model_exchange = {
        'fmi2EnterEventMode', 'fmi2NewDiscreteStates', 'fmi2EnterContinuousTimeMode',
        'fmi2CompletedIntegratorStep', 'fmi2SetTime', 'fmi2SetContinuousStates',
        'fmi2GetDerivatives', 'fmi2GetEventIndicators', 'fmi2GetContinuousStates',
        'fmi2GetNominalsOfContinuousStates'}
    assert len(declared) > 40
    assert declared - defined == (of_model_exchange if version == 2 else set())
