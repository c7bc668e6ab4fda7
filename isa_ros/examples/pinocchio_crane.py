"""
A Pinocchio model as the body: a crane of two cylinders (``pip install -e '.[pinocchio]'``).

    python -m isa_ros.examples.pinocchio_crane

`PinocchioBody` takes any model whose cylinders reach from frame NAME_base to frame NAME_rod.
The crane is that of docs/bodies.md, where MuJoCo simulates it.
"""

from collections.abc import Callable, Mapping

import isa_ros
from isa_ros.config.text.yaml_text import Tree
from isa_ros.errors import ConfigError
import numpy as np
from numpy.typing import NDArray
import pinocchio as pin

Floats = NDArray[np.float64]
WORLD = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


class PinocchioBody:
    """
    A Pinocchio model as an `isa_ros.Mechanism`: x is the length of each cylinder.

    With unit vector u from base to rod and their relative speed w: x' = u w and
    x'' = u w' + (w^2 - x'^2)/x. A force along u turns the joints by J^T f, J = u (J_rod - J_base).
    """

    def __init__(self, model: pin.Model, q: Floats, mounting: isa_ros.Mounting) -> None:
        self._model, self._data = model, model.createData()
        self._ends = [tuple(_frame(model, f'{name}_{end}') for end in ('base', 'rod'))
                      for name in mounting.names]
        self.state = np.concatenate([q, np.zeros(model.nv)])
        self._closed = np.zeros(len(self._ends))
        first = self.motion(self.state, self._closed)
        self._closed = first.position - mounting.positions

    @property
    def provenance(self) -> Mapping[str, str]:
        """Return what a bag says about it."""
        return {'simulator': f'Pinocchio {pin.__version__}', 'model': self._model.name}

    def motion(self, state: Floats, forces: Floats) -> isa_ros.Motion:
        """Return lengths, their speeds and accelerations under forces along the cylinders."""
        model, data = self._model, self._data
        q, v = state[:model.nq], state[model.nq:]
        a = self._accelerations(q, v, forces)
        pin.forwardKinematics(model, data, q, v, a)
        pin.updateFramePlacements(model, data)
        lengths, speeds, accelerations = [], [], []
        for base, rod in self._ends:
            reach = data.oMf[rod].translation - data.oMf[base].translation
            x = np.linalg.norm(reach)
            u = reach / x
            w = self._apart(pin.getFrameVelocity, base, rod)
            dw = self._apart(pin.getFrameClassicalAcceleration, base, rod)
            speed = u @ w
            lengths.append(x)
            speeds.append(speed)
            accelerations.append(u @ dw + (w @ w - speed * speed) / x)
        return isa_ros.Motion(
            np.array(lengths) - self._closed, np.array(speeds), np.array(accelerations), a)

    def stepped(self, state: Floats, forces: Floats, seconds: float) -> Floats:
        """Return the state after a Runge-Kutta step for each fifth of the tick."""
        model, h = self._model, seconds / len(forces)
        q, v = state[:model.nq], state[model.nq:]
        for row in forces:
            a_1 = self._accelerations(q, v, row)
            v_2 = v + 0.5 * h * a_1
            a_2 = self._accelerations(pin.integrate(model, q, 0.5 * h * v), v_2, row)
            v_3 = v + 0.5 * h * a_2
            a_3 = self._accelerations(pin.integrate(model, q, 0.5 * h * v_2), v_3, row)
            v_4 = v + h * a_3
            a_4 = self._accelerations(pin.integrate(model, q, h * v_3), v_4, row)
            q = pin.integrate(model, q, h / 6.0 * (v + 2.0 * v_2 + 2.0 * v_3 + v_4))
            v = v + h / 6.0 * (a_1 + 2.0 * a_2 + 2.0 * a_3 + a_4)
        return np.concatenate([q, v])

    def displaced(self, state: Floats, dq: Floats, dv: Floats) -> Floats:
        """Return the state moved; for stiffness and damping, if they are asked for."""
        model = self._model
        return np.concatenate([
            pin.integrate(model, state[:model.nq], dq), state[model.nq:] + dv])

    def _accelerations(self, q: Floats, v: Floats, forces: Floats) -> Floats:
        """Return q'' under forces along the cylinders: the articulated body algorithm."""
        model, data = self._model, self._data
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        torques = np.zeros(model.nv)
        for (base, rod), force in zip(self._ends, forces):
            reach = data.oMf[rod].translation - data.oMf[base].translation
            turned = (pin.getFrameJacobian(model, data, rod, WORLD)
                      - pin.getFrameJacobian(model, data, base, WORLD))[:3]
            torques += force / np.linalg.norm(reach) * (reach @ turned)
        return np.array(pin.aba(model, data, q, v, torques))

    def _apart(self, of: Callable[..., pin.Motion], base: int, rod: int) -> Floats:
        """Return the speed or acceleration of the rod's frame less that of the base's."""
        model, data = self._model, self._data
        return np.array(of(model, data, rod, WORLD).linear - of(model, data, base, WORLD).linear)


def _frame(model: pin.Model, name: str) -> int:
    if not model.existFrame(name):
        raise ConfigError(f'the Pinocchio model {model.name} has no frame {name}')
    return int(model.getFrameId(name))


def crane_model() -> pin.Model:
    """Return boom and jib with a load of 30 kg, each on a joint about -y."""
    model = pin.Model()
    model.name = 'crane'
    boom = model.addJoint(0, _hinge(), _at(0.0, 0.0, 1.0), 'boom')
    jib = model.addJoint(boom, _hinge(), _at(1.5, 0.0, 0.0), 'jib')
    model.appendBodyToJoint(boom, pin.Inertia.FromCapsule(60.0, 0.05, 1.5), _along_x(0.75))
    model.appendBodyToJoint(jib, pin.Inertia.FromCapsule(30.0, 0.04, 1.0), _along_x(0.5))
    model.appendBodyToJoint(jib, pin.Inertia.FromSphere(30.0, 0.1), _at(1.0, 0.0, 0.0))
    for name, joint, place in (
            ('boom_base', 0, (0.2, 0.0, 0.4)), ('boom_rod', boom, (0.5, 0.0, 0.0)),
            ('jib_base', boom, (1.0, 0.0, 0.2)), ('jib_rod', jib, (0.3, 0.0, 0.1))):
        model.addFrame(pin.Frame(name, joint, _at(*place), pin.FrameType.OP_FRAME))
    return model


def _hinge() -> pin.JointModelRevoluteUnaligned:
    return pin.JointModelRevoluteUnaligned(np.array([0.0, -1.0, 0.0]))


def _at(*place: float) -> pin.SE3:
    return pin.SE3(np.eye(3), np.array(place))


def _along_x(centre: float) -> pin.SE3:
    """Return the placement of a capsule, whose axis is z, along x."""
    return pin.SE3(np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]),
                   np.array([centre, 0.0, 0.0]))


def crane(mounting: isa_ros.Mounting) -> PinocchioBody:
    """Return the crane at its pose of t = 0; called once for every simulation."""
    return PinocchioBody(crane_model(), np.array([0.5, -1.0]), mounting)


CRANE: Tree = {
    'name': 'crane', 'supply': {'kind': 'constant', 'pressure_mpa': 20.7,
                                'return_pressure_mpa': 0.0},
    'body': {'kind': 'external', 'actuators': ['boom', 'jib'],
             'class': 'isa_ros.examples.pinocchio_crane:crane'},
    'actuators': {name: {'model': 'isa_v5', 'initial_position_mm': 50.0}
                  for name in ('boom', 'jib')}}


def main() -> None:
    """Let the crane stand for 0.3 s and print the motion of its cylinders."""
    result = isa_ros.load(CRANE).simulate(0.3)
    for name in ('boom', 'jib'):
        place, force = result[f'body.{name}_position'], result[f'{name}.force']
        print(f'{name}: {1e3 * place[0]:.2f} mm, after 0.3 s {1e3 * place[-1]:.2f} mm, '
              f'{force[-1]:.0f} N')


if __name__ == '__main__':
    main()
