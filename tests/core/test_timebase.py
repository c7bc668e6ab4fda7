"""The grid of time: what a macro step and an offset of the controllers' samples may be."""

import re

from isa_ros.core.timebase import MAX_STEP_NS, PLANT_STEP_NS, refuse_grid
from isa_ros.errors import ConfigError
import pytest

STEP_NS = 1_000_000


@pytest.mark.parametrize('offset_ns', [0, PLANT_STEP_NS, STEP_NS - PLANT_STEP_NS])
def test_an_offset_within_the_step_is_taken(offset_ns):
    """A controller samples at k step + offset: from the tick itself to the last plant step."""
    refuse_grid(STEP_NS, offset_ns, 'rig.yaml')


@pytest.mark.parametrize('offset_ns', [STEP_NS, STEP_NS + PLANT_STEP_NS, -PLANT_STEP_NS])
def test_an_offset_of_a_whole_step_is_refused(offset_ns):
    """It would be the next tick's offset 0, whose command the sample must not yet have."""
    with pytest.raises(ConfigError, match='^' + re.escape(
            f'rig.yaml: controller_offset_ns = {offset_ns:g} ns, must be >= 0 and < step_ns = '
            f'{STEP_NS} ns')):
        refuse_grid(STEP_NS, offset_ns, 'rig.yaml')


def test_an_offset_between_plant_steps_is_refused():
    """Loops run at plant steps."""
    with pytest.raises(ConfigError, match='a multiple of 20000 ns'):
        refuse_grid(STEP_NS, PLANT_STEP_NS + 1, 'rig.yaml')


@pytest.mark.parametrize('step_ns', [0, -100_000, 90_000, MAX_STEP_NS + 100_000])
def test_a_step_without_five_windows_of_plant_steps_is_refused(step_ns):
    """Five windows of whole plant steps: multiples of 0.1 ms up to 100 ms."""
    with pytest.raises(ConfigError, match=r'rig.yaml: step_ns = .* a multiple of 100000 ns'):
        refuse_grid(step_ns, 0, 'rig.yaml')


@pytest.mark.parametrize('step_ns', [100_000, 700_000, MAX_STEP_NS])
def test_both_ends_of_the_range_are_taken(step_ns):
    """The largest step is one that may be."""
    refuse_grid(step_ns, 0, 'rig.yaml')
