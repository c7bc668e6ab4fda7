"""A robot as a body: its account, its release, pushes, saved states, and what is refused."""

from dataclasses import replace
import math

from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.errors import ConfigError, RunError, SimulationDiverged
from isa_ros.surroundings.bodies.robot.robot import Robot
from isa_ros.surroundings.bodies.robot.sheet import (
    Push, RobotSheet, RobotStart, RobotUnit, vector)
import numpy as np
import pytest
from tests.legs import leg_sheet
from tests.surroundings.bodies.robot.made import quadruped

MS = 1_000_000
SHEET = quadruped(leg_sheet())
POSE = tuple(4 * [math.radians(angle) for angle in (3.0, 41.3, -80.0)])
TILTED = 0.9990482215818578, 0.02617694830787315, 0.03489949670250097, 0.0
START = RobotStart(joints=POSE, position=(0.0, 0.0, 0.7), quaternion=tuple(
    np.array(TILTED) / math.sqrt(np.square(TILTED).sum())))
K = len(SHEET.drives)
SPRINGS = np.tile([900.0, 9e5, 9e5], 4)     # Nm/rad, N/m
DAMPERS = np.tile([9.0, 9e3, 9e3], 4)


def made(sheet: RobotSheet = SHEET, start: RobotStart = START, **given) -> Robot:
    return Robot(sheet, start, MS, **given)


class Held:
    """A robot on springs at its actuators, from its start on."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self.hold = robot, robot.actuator_forces
        self.ports, self.replies = np.zeros(K, LOAD_PORT), np.zeros(K, LOAD_REPLY)
        robot.ports(self.ports)
        self.start = self.ports['x0'].copy()

    def tick(self, n: int = 1) -> np.void:
        for _ in range(n):
            self.robot.ports(self.ports)
            force = (self.hold + SPRINGS * (self.start - self.ports['x0'])
                     - DAMPERS * self.ports['v0'])
            self.replies['mean_forces'], self.replies['force'] = force[:, None], force
            self.robot.advance(self.replies)
        return self.robot.sample[0].copy()


def account(sample: np.void) -> float:
    """Return what is constant  (L30)."""
    plus = ('kinetic_energy', 'potential_energy', 'elastic_energy', 'ground_loss')
    total = sum(float(sample[name]) for name in plus)
    return total - float(sample['drive_work']) - float(sample['push_work'])


def test_energy_closes_through_a_fall_an_impact_and_a_push() -> None:
    """Within 1e-6 of what the robot had to give, at every tick, from the release on."""
    own = Held(made(release_ns=5 * MS))
    samples = [own.tick()]
    own.robot.change(Push(push_y=400.0, push_yaw=-30.0))
    samples += [own.tick() for _ in range(299)]
    accounts = [account(sample) for sample in samples]
    last = samples[-1]
    throughput = last['ground_loss'] + abs(last['drive_work']) + abs(last['push_work'])
    assert last['ground_loss'] > 0.5 and abs(last['push_work']) > 5.0
    assert max(own['lf_foot_force'][2] for own in samples) > 500.0
    assert np.ptp(accounts) < 1e-6 * throughput


def test_a_held_robot_waits_for_its_release() -> None:
    """The root stays, the holding forces keep the joints; then it falls with g."""
    own = Held(made(release_ns=3 * MS))
    before = own.tick(3)
    assert own.robot.is_held and before['position'].tolist() == [0.0, 0.0, 0.7]
    assert np.abs([before[f'lf_{name}_velocity'] for name in ('haa', 'hfe', 'kfe')]).max() < 1e-9
    after = own.tick()
    assert not own.robot.is_held
    assert after['velocity'][2] == pytest.approx(-STANDARD_GRAVITY * 1e-3, rel=0.2)


def test_a_push_adds_momentum() -> None:
    """In the air: m dv_c = F t of the whole robot, and about the root its moment turns it."""
    robots = [Held(made(start=replace(START, position=(0.0, 0.0, 9.0)))) for _ in range(2)]
    for own in robots:
        own.robot.release()
    robots[1].robot.change(Push(push_x=200.0, push_z=50.0, push_roll=20.0))
    momenta = []
    for own in robots:
        sample, masses = own.tick(50), np.array([link.mass for link in SHEET.links])
        del sample
        links = own.robot._arrays.links
        v = links['velocity'] + np.cross(links['turning'], links['origin'] + np.einsum(
            'nij,nj->ni', links['axes'].reshape(-1, 3, 3), links['com']))
        momenta.append(masses @ v)
    assert momenta[1] - momenta[0] == pytest.approx([10.0, 0.0, 2.5], rel=1e-9, abs=1e-9)
    assert robots[1].robot.sample['angular_velocity'][0, 0] > 0.1
    robots[1].robot.change(Push())
    before = robots[1].robot.sample['push_work'][0]
    robots[1].tick()
    assert robots[1].robot.sample['push_work'][0] == before


def test_a_saved_robot_continues_byte_for_byte() -> None:
    """In the air, held, and while it lands; the release is still ahead, or over."""
    own, again = Held(made(release_ns=4 * MS)), Held(made(release_ns=4 * MS))
    for n in (2, 80, 90):
        own.tick(n)
        again.robot.restore(own.robot.snapshot())
        assert again.tick(3).tobytes() == own.tick(3).tobytes()
        assert again.robot.snapshot() == own.robot.snapshot()
        assert again.robot.t_ns == own.robot.t_ns and again.robot.is_held == own.robot.is_held


def test_a_state_that_breaks_is_named() -> None:
    own = Held(made(release_ns=0))
    own.hold = own.hold + np.where(np.arange(K) == 4, math.inf, 0.0)
    with pytest.raises(SimulationDiverged, match=r'robot\.'):
        own.tick(2)
    with pytest.raises(SimulationDiverged, match=r'robot\.'):
        own.robot.snapshot()


def test_a_sample_that_is_broken_is_not_saved() -> None:
    """Nor read: what listeners have is part of the saved run."""
    robot = made()
    snapshot = bytearray(robot.snapshot())
    name = robot.sample.dtype.names[-1]
    robot.sample[name] = math.inf
    with pytest.raises(SimulationDiverged, match=rf'robot\.{name}'):
        robot.snapshot()
    snapshot[-8:] = np.array(math.nan).tobytes()
    with pytest.raises(ConfigError, match=f'robot: saved state has {name} = nan, must be finite'):
        robot.restore(bytes(snapshot))


def test_a_saved_state_that_is_broken_is_refused() -> None:
    robot = made()
    snapshot = bytearray(robot.snapshot())
    snapshot[8:16] = np.array(math.nan).tobytes()
    with pytest.raises(ConfigError, match='robot: saved state has state = nan, must be finite'):
        robot.restore(bytes(snapshot))


def test_a_contact_may_end_the_run() -> None:
    """Without springs the legs fold, and the trunk's corner comes down."""
    own = Held(made(quadruped(leg_sheet(), ends_run=True), release_ns=0))
    own.hold, own.start = np.zeros(K), np.zeros(K)
    with pytest.raises(RunError, match=r'_corner touches the ground at t = 0\.\d+ s'):
        for _ in range(900):
            own.start = own.ports['x0'].copy()
            own.tick()


def test_a_unit_on_a_held_trunk_reads_gravity() -> None:
    """In its own axes: turned by a quarter about x, what points up is its y."""
    quarter = (1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)
    unit = RobotUnit('imu', 0, vector((0.1, 0.2, 0.3)), quarter, 0.0, 0.0, 0.0, 0.0, MS, 1)
    robot = made(start=RobotStart(joints=POSE, position=(0.0, 0.0, 0.7)), units=[unit])
    assert robot.sample['imu_specific_force'][0] == pytest.approx(
        [0.0, STANDARD_GRAVITY, 0.0], abs=1e-12)
    assert list(robot.units)[-2:] == ['imu_specific_force', 'imu_angular_velocity']


@pytest.mark.parametrize(('changes', 'message'), [
    ({'joints': POSE[1:]}, 'the start has 11 joint coordinates, must have 12'),
    ({'joints': (9.0, *POSE[1:])}, r'start of lf_haa = 9, must be within -?[\d.]+\.\.[\d.]+'),
    ({'quaternion': (1.0, 0.1, 0.0, 0.0)}, 'the quaternion of the start has length 1.00499'),
    ({'held_joints': ('knee',)}, 'held joint knee, must be one of lf_haa, '),
    ({'held_joints': ('lf_kfe',)}, 'lf_kfe is held at the start, must have no actuator: lf_kfe_'),
])
def test_a_start_that_cannot_be_is_refused(changes: dict, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        made(start=replace(START, **changes))


def test_a_long_flight_leaves_no_small_numbers() -> None:
    """A shear decays in the air: to 0, not to denormal numbers; the quaternion keeps length 1."""
    own = Held(made(release_ns=0))
    own.tick(170)
    snapshot = own.robot.snapshot()
    at = 8 + 8 * 2      # behind the time: the place in the world, its z
    own.robot.restore(snapshot[:at] + np.array(9.0).tobytes() + snapshot[at + 8:])
    state = np.frombuffer(own.robot.snapshot(), np.float64, 19 + 18 + 16, 8)
    assert np.count_nonzero(state[37:]) >= 4
    own.tick(60)
    state = np.frombuffer(own.robot.snapshot(), np.float64, 19 + 18 + 16, 8)
    assert np.all(state[37:] == 0.0)
    assert abs(math.sqrt(np.square(state[3:7]).sum()) - 1.0) < 1e-15


@pytest.mark.parametrize(('axis', 'name'), enumerate(('push_roll', 'push_pitch', 'push_yaw')))
def test_a_moment_turns_the_root_about_its_axis(axis: int, name: str) -> None:
    """Roll, pitch and yaw are about x, y and z: its work is what w has of that axis."""
    robots = [Held(made(start=replace(START, position=(0.0, 0.0, 9.0)))) for _ in range(2)]
    for own in robots:
        own.robot.release()
    robots[1].robot.change(Push(**{name: 50.0}))
    plain, pushed = (own.tick(10) for own in robots)
    gained = pushed['angular_velocity'] - plain['angular_velocity']
    assert np.abs(gained).argmax() == axis and gained[axis] > 0.01
    assert pushed['push_work'] > 0.0


def test_the_sample_has_what_acts_at_joints_and_feet() -> None:
    """Torque = lever times force at each joint; feet touch or not, and store 2/5 k d^2.5."""
    air = Held(made())
    sample = air.tick()
    for drive, force in zip(SHEET.drives, air.replies['force']):
        joint = drive.actuator.removesuffix('_drive')
        assert sample[f'{joint}_torque'] == pytest.approx(
            sample[f'{drive.actuator}_lever'] * force, rel=1e-12, abs=0.0)
    assert sample['lf_foot_touches'] == sample['elastic_energy'] == 0.0
    depth = 1e-3
    lowest = min(sample[f'{leg}_foot_position'][2] for leg in ('lf', 'rf', 'lh', 'rh'))
    deep = made(start=replace(START, position=(0.0, 0.0, 0.7 - lowest - depth))).sample[0]
    assert [deep[f'{leg}_foot_touches'] for leg in ('lf', 'rf', 'lh', 'rh')].count(1.0) == 1
    assert deep['elastic_energy'] == pytest.approx(
        0.4 * leg_sheet().ground.stiffness * depth ** 2.5, rel=1e-6, abs=0.0)
