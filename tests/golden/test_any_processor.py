"""The same bytes whatever instructions the processor and the C library have."""

import hashlib
import os
from pathlib import Path
import subprocess
import sys

import pytest

ROOT = Path(__file__).parents[2]
PROGRAM = """
import hashlib, json
from isa_ros.config.paths import CONFIG, SCENARIOS, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.scenario.scenario import load_scenario
from tests.golden.message_digests import digests
run = load_run(shipped(CONFIG)['leg.yaml'])
for name in ('drop.yaml', 'trot_leg.yaml'):
    print(json.dumps(digests(load_scenario(shipped(SCENARIOS)[name], run))))
"""
WITHOUT_FMA = {
    'GLIBC_TUNABLES': 'glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX512F',
    'NPY_DISABLE_CPU_FEATURES': 'AVX2 FMA3 AVX512F AVX512CD AVX512_SKX'}


def digest(**environment: str) -> str:
    """Return a digest of all messages of two runs of the leg, in a process of its own."""
    done = subprocess.run(
        [sys.executable, '-W', 'ignore', '-c', PROGRAM], cwd=ROOT, check=True, timeout=900,
        env={**os.environ, **environment}, stdout=subprocess.PIPE)
    assert done.stdout
    return hashlib.sha256(done.stdout).hexdigest()


def test_c_library_without_fma_and_avx_gives_the_same_bytes():
    assert digest(**WITHOUT_FMA) == digest()


@pytest.mark.long
def test_kernels_compiled_for_any_x86_64_give_the_same_bytes(tmp_path):
    """The kernels are compiled anew, for the oldest processor of the kind."""
    oldest = digest(
        **WITHOUT_FMA, NUMBA_CPU_NAME='x86-64', NUMBA_CPU_FEATURES='',
        NUMBA_CACHE_DIR=str(tmp_path))
    assert oldest == digest()
