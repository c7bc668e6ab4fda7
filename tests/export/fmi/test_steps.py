"""A step that no unit can make ends a simulation; an importer does not repeat it for ever."""

from isa_ros.export.fmi.description import Version
import pytest

fmpy = pytest.importorskip('fmpy')
fmi1 = pytest.importorskip('fmpy.fmi1')

pytestmark = pytest.mark.slow
MOST = 20    # messages, after which the simulation would not end


class Repeats(Exception):
    """The importer goes on with a step that was refused."""


@pytest.mark.parametrize('version', Version)
def test_a_wrong_interval_ends_the_simulation_with_one_message(cases, version):
    found = []

    def log(*arguments):
        found.append(arguments[-1])
        if len(found) > MOST:
            raise Repeats

    def step(t, _):
        found.append(t)
        if len(found) > MOST:
            raise Repeats
        return True
    with pytest.raises(fmi1.FMICallException, match='DoStep failed with status 3'):
        fmpy.simulate_fmu(
            str(cases('moving').paths[version]), stop_time=0.01, output_interval=0.0015,
            logger=log, step_finished=step)
    messages = [text for text in found if not isinstance(text, float)]
    assert len(messages) == 1
    assert b'a step of 0.0015 s, must be a multiple of the tick, 0.001 s' in (
        messages[0] if isinstance(messages[0], bytes) else messages[0].encode())
