"""What a master of CiA 402 drives knows: commands, states, and the way to operation."""

from .rig import Master

SHUTDOWN, SWITCH_ON, ENABLE, STOP, VOLTAGE_OFF, RESET = 0x06, 0x07, 0x0F, 0x02, 0x00, 0x80
CSP, CSV, CST, IMPEDANCE = 8, 9, 10, -1
MODE, MODE_SHOWN = (0x6060, 0), (0x6061, 0)
POSITION, VELOCITY, TORQUE = (0x6064, 0), (0x606C, 0), (0x6077, 0)


def state(word):
    """Return the state that a status word shows, as CiA 402 tells them apart."""
    for mask, value, name in (
            (0x4F, 0x00, 'NOT_READY'), (0x4F, 0x40, 'SWITCH_ON_DISABLED'), (0x6F, 0x21, 'READY'),
            (0x6F, 0x23, 'SWITCHED_ON'), (0x6F, 0x27, 'OPERATION_ENABLED'),
            (0x6F, 0x07, 'QUICK_STOP'), (0x4F, 0x0F, 'FAULT_REACTION'), (0x4F, 0x08, 'FAULT')):
        if word & mask == value:
            return name
    raise AssertionError(f'{word:#06x} is no state of CiA 402')


def is_in(*names):
    return lambda word: state(word) in names


def enabled(rig, mode=CSP, **targets):
    """Return a master that has enabled operation at the present position."""
    master = Master(rig)
    master.outputs[0x607A, 0] = master.upload(0x6064)
    for control in (SHUTDOWN, SWITCH_ON, ENABLE):
        master.cycle(control, x6060=mode, **targets)
    master.cycle_until(is_in('OPERATION_ENABLED'), ENABLE)
    return master
