"""
The frequency response of a control block, from the block itself: its answer to an impulse.

A block without limit and compensation is linear, U = C_r R - C_y Y. Its kernel is run on an
impulse of the reference and of the measured value, so that C_r and C_y are those of the block
that runs in the REU, sampling and filters included.
"""

from dataclasses import replace
import math

from isa_ros.core.frozen import frozen
from isa_ros.core.record import rows_of
from isa_ros.reu.block import block_record, BLOCK_STATE, block_step, Pid
from isa_ros.reu.compensation import Linear
from isa_ros.reu.schedule import POINTS
import numpy as np

SAMPLES = 400       # of an impulse response: 80 ms at 5 kHz, past the filters on derivatives
_KF = 1e-3          # s, at which the part of K_f is taken


def responses(
        sheet: Pid, frequency: np.ndarray, factor: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """
    Return (C_r, C_y) of a block, complex, (n,) each, in output per measured.

    ``frequency`` is in Hz, ``factor`` that of the gain schedule. The sheet's offset, compensation
    and limit have no influence: the output is the demand.
    """
    linear = replace(sheet, offset=0.0, retracting_factor=1.0, compensation=Linear())
    block = block_record(linear, np.full(POINTS, factor))
    block.limit = math.inf
    return (_transform(_impulse(block, (1.0, 0.0)), frequency * block.period),
            -_transform(_impulse(block, (0.0, 1.0)), frequency * block.period))


def _impulse(block: np.record, inputs: tuple[float, float]) -> np.ndarray:
    """Return the outputs after one sample of reference and measured value, (`SAMPLES`,)."""
    state, outputs = rows_of(1, BLOCK_STATE)[0], np.zeros(SAMPLES)
    for k in range(SAMPLES):
        reference, measured = inputs if k == 0 else (0.0, 0.0)
        block_step(reference, measured, 0.0, 0.0, 1.0, block, state)
        outputs[k] = state.output
    return outputs


def _transform(outputs: np.ndarray, cycles: np.ndarray) -> np.ndarray:
    """Return the response at ``cycles`` per sample; what is left at the end is an integral's."""
    z = np.exp(-2j * math.pi * cycles)
    rest = outputs[-1]
    found: np.ndarray = (
        np.polynomial.polynomial.polyval(z, outputs - rest) + rest / (1.0 - z))
    return found


@frozen
class ResponseParts:
    """
    The parts of C_r or C_y: C = d + K_f d_f + w (K_p (p + K_f p_f) + K_i (i + K_f i_f)).

    Every block that is linear in its gains and their products with K_f has them, wherever K_f
    acts; w is the factor of the gain schedule, d the part of K_d and K_r. (n,) each.
    """

    d: np.ndarray
    d_f: np.ndarray
    p: np.ndarray
    p_f: np.ndarray
    i: np.ndarray
    i_f: np.ndarray

    def at(self, kp: float, ki: float, kf: float) -> np.ndarray:
        """Return the response with these gains; a factor of the schedule is in kp and ki."""
        found: np.ndarray = (
            self.d + kf * self.d_f + kp * (self.p + kf * self.p_f)
            + ki * (self.i + kf * self.i_f))
        return found


def parts(sheet: Pid, frequency: np.ndarray) -> tuple[ResponseParts, ResponseParts]:
    """Return the parts of C_r and of C_y."""
    def both(kp: float, ki: float, kf: float) -> np.ndarray:
        return np.array(responses(replace(sheet, kp=kp, ki=ki, kf=kf), frequency))
    d, damped = both(0.0, 0.0, 0.0), both(0.0, 0.0, _KF)
    p, i = both(1.0, 0.0, 0.0) - d, both(0.0, 1.0, 0.0) - d
    p_f, i_f = ((both(*gains, _KF) - damped - without) / _KF
                for gains, without in (((1.0, 0.0), p), ((0.0, 1.0), i)))
    of_reference, of_measured = (
        ResponseParts(*rows) for rows in zip(d, (damped - d) / _KF, p, p_f, i, i_f))
    return of_reference, of_measured
