"""
A run that goes on while pages show it, in this process and without ROS.

The run is the same as without a page: the same loop, the same recorder, the same bytes. Orders of
the pages are carried out between two ticks, and what they change is in the bag with its tick, as
after a service or a topic of ROS. Pages get frames about thirty times a second; those that a page
does not take are dropped, ticks are not.
"""

from collections.abc import Callable
from pathlib import Path
import time

from isa_ros.actuator.group import ActuatorGroup
from isa_ros.config.assembly import group_of, surroundings_of
from isa_ros.core.conditions import conditions
from isa_ros.core.device import state_name
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError, IsaError, SetpointError
from isa_ros.run.coordinator import Coordinator, Interrupted
from isa_ros.run.outlets import Outlets
from isa_ros.run.session import record, Report, Session
from isa_ros.run.warm_up import warmed_up
from isa_ros.surroundings.surroundings import Surroundings
from isa_ros.tick.calling import calling
from isa_ros.tick.exchange import Rows, RowSink
from isa_ros.tick.in_process import InProcess
from isa_ros.view.columns import Columns
from isa_ros.view.controls import Controls
from isa_ros.view.drags import Drags
from isa_ros.view.frames import frame_of, Gathering, PERIOD_S
from isa_ros.view.hub import Hub
from isa_ros.view.orders import (
    Order, OrderAnswer, PAUSE, RESTART, SEEK, SETPOINT, SLOWEST, SPEED, STEP, STOP, ticks_text)
from isa_ros.view.pages import ViewPage
from isa_ros.view.panels import groups_of
from isa_ros.view.scene import scene_of
from isa_ros.view.server import serving

_FOREVER = 1 << 62


class LiveRun(RowSink):
    """
    The pages of a run: takes its rows, and carries out orders between its ticks.

    ``folder`` is that of its run file; ``now`` the host time, s.
    """

    def __init__(
            self, session: Session, group: ActuatorGroup, surroundings: Surroundings,
            folder: Path, now: Callable[[], float] = time.perf_counter) -> None:
        run = session.run
        n_ticks = session.scenario.n_ticks
        page = ViewPage(session.out.name, groups_of(run), scene_of(run, folder))
        self._session, self._channels = session, page.channels
        self._controls = Controls(run, group, surroundings)
        self._gathering = Gathering(len(self._channels))
        self._columns: Columns | None = None
        self._answers: list[OrderAnswer] = []
        self._now, self._next = now, 0.0
        self._drags, self._host = Drags(), 0.0
        self._coordinator: Coordinator | None = None
        self.hub = Hub(page.tree(
            run, 'run', None if n_ticks is None else n_ticks * run.step_ns / NS_PER_SECOND,
            note='', controls=self._controls.tree()))
        """Its pages."""

    def take(self, tick: int, rows: Rows) -> None:
        """Keep the sample of a tick for the next frame."""
        if not self.hub.has_viewers:
            return
        if self._columns is None:
            self._columns = Columns(self._session.run, rows, self._channels)
        row = self._gathering.row(tick)
        if row is not None:
            self._columns.fill(row)

    def quiet_ticks(self, tick: int) -> int:
        """Return how many ticks after ``tick`` may pass without `take`: all without a page."""
        return 0 if self.hub.has_viewers else _FOREVER

    def serve(self, coordinator: Coordinator) -> None:
        """Carry out the orders since the last call; send a frame when it is due."""
        self._coordinator, self._host = coordinator, self._now()
        for order in self.hub.taken():
            self._answers.append(self._answer(order, coordinator))
        for event in self._drags.ended(self._host):
            coordinator.add_event(event)
        if self._host >= self._next:
            self._next = self._now() + PERIOD_S
            self.send(coordinator)

    def end(self) -> None:
        """Note the drags that go on at the end of the run."""
        for event in self._drags.ended():
            assert self._coordinator is not None, 'it has served the drag'
            self._coordinator.add_event(event)

    def end_pages(self) -> None:
        """Send the last frame, if the run has begun."""
        if self._coordinator is not None:
            self.send(self._coordinator, is_over=True)

    def send(self, coordinator: Coordinator, *, is_over: bool = False) -> None:
        """Send a frame to the pages."""
        answers, self._answers = self._answers, []
        if not self.hub.has_viewers:
            return
        pace = self._session.pace
        self.hub.send(frame_of(
            self._gathering.take(), tick=coordinator.ticks, is_paused=coordinator.is_paused,
            speed=pace.factor, is_over=is_over, answers=[own._asdict() for own in answers],
            behind=0.0 if coordinator.is_paused else pace.lateness(coordinator.t_ns),
            devices=_devices(coordinator.rows), **self._controls.state()))

    def _answer(self, order: Order, coordinator: Coordinator) -> OrderAnswer:
        tick = coordinator.ticks
        try:
            text = self._carry_out(order, coordinator)
        except IsaError as error:
            if error.exit_code != IsaError.exit_code:   # the run itself has failed
                raise
            return OrderAnswer(order.number, False, str(error), tick)
        return OrderAnswer(order.number, True, text, tick)

    def _carry_out(self, order: Order, coordinator: Coordinator) -> str:
        """Carry out an order; return what was done."""
        if order.what == PAUSE:
            coordinator.pause(order.value)
            return 'paused' if order.value else 'runs'
        if order.what == STEP:
            coordinator.pause(True)
            coordinator.step(order.value)
            return ticks_text(order.value)
        if order.what == SPEED:
            if 0.0 < order.value < SLOWEST:
                raise SetpointError(f'speed: value = {order.value:g}, must be >= {SLOWEST:g}, or '
                                    '0 (as fast as possible)')
            coordinator.set_real_time_factor(order.value)
            return f'{order.value:g} times real time'
        if order.what == RESTART:
            coordinator.reset()
            self._controls.restart()
            return 'starts again at t = 0, with another bag'
        if order.what == STOP:
            coordinator.emergency_stop(order.value)
            return f'emergency stop {"opened" if order.value else "released"}'
        if order.what == SEEK:
            raise SetpointError('seek: a run goes forward only')
        text = self._controls.carry_out(order)
        if order.what == SETPOINT:
            self._drags.move(order.of, order.name, text, coordinator.ticks, self._host)
        return text


def _devices(rows: Rows) -> list[str]:
    """Return what each device does, in words: its state, its trips and warnings."""
    found = []
    for sample in rows.samples:
        words = [state_name(sample['device_state'])]
        for kind in ('trips', 'warnings'):
            if names := conditions(int(sample[kind])):
                words.append(f'{kind}: {", ".join(names)}')
        found.append('; '.join(words))
    return found


def view_run(
        session: Session, port: int, folder: Path, tell: Callable[[str], object],
        report: Report | None, should_stop: Callable[[], bool]) -> None:
    """
    Run and record a session; ``tell`` gets the address of its page, and the first page begins it.

    Raises
    ------
    ConfigError
        The port cannot be used, or a controller of the run is a node.
    RunError, SimulationDiverged, Interrupted
        As `isa_ros.nodes.bringup.bringup`.

    """
    run = session.run
    if run.controllers:
        raise ConfigError(
            f'{run.source}: controllers: {", ".join(run.controllers)} cannot take part: isa view '
            'has no nodes; give the controller a class, or leave it out')
    warmed_up(run)
    surroundings, group = surroundings_of(run), group_of(run)
    transport = calling(run, InProcess(group, surroundings.starts()))
    live = LiveRun(session, group, surroundings, folder)
    with serving(live.hub, port) as address:
        tell(address)
        while not live.hub.was_opened.wait(PERIOD_S):
            if should_stop():
                raise Interrupted('stopped before a page was opened')
        session.freeze_objects()
        try:
            record(session, transport, surroundings, lambda topics: Outlets(), report,
                   should_stop, live.serve, sinks=(live,))
        finally:
            live.end_pages()
