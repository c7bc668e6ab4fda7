"""What docs/controller.md names is there."""

import re

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.controller import Controller, Setpoint, State
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
from tests.docs.pages import text_of


def test_what_a_controller_is_shown_is_named_as_it_is() -> None:
    """Every `state.` of the page is a field of the state of the shipped leg."""
    shown: list[State] = []

    class Look(Controller):
        def step(self, state: State) -> dict[str, Setpoint]:
            shown.append(state)
            return {}

    Simulation(idle(load_run(find('leg.yaml', CONFIG))), [Look()]).step()
    page = text_of('controller')
    names = set(re.findall(r"\bstate\.[a-z_]+(?:\['\w+'\])?(?:\.[a-z_]+)?", page))
    assert names >= {'state.body', "state.supplies['supply'].pressure", "state.actuators['hfe']"}
    for name in names:
        assert eval(name, {'state': shown[0]}) is not None
