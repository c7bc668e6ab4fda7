"""What a supply shows of itself at the end of a tick."""

from isa_ros.core.fields import Field, record_type

SUPPLY_FIELDS = (
    Field('pressure', 'Pa', 'gauge'),
    Field('return_pressure', 'Pa', 'gauge'),
    Field('pump_flow', 'm3/s', '0 for an ideal supply'),
    Field('drawn', 'm3', 'volume drawn by the actuators since t = 0'),
    Field('returned', 'm3', 'volume returned by the actuators since t = 0'),
    Field('power', 'W', 'of the oil drawn less that returned, mean over the tick'),
    Field('peak_power', 'W', 'greatest power since t = 0'),
    Field('energy', 'J', 'integral of the power since t = 0'),
    Field('pump_energy', 'J', 'of the pump since t = 0'),
    Field('relief_energy', 'J', 'lost through relief and dump valve since t = 0'),
    Field('return_energy', 'J', 'lost on the way of returned oil to the tank since t = 0'),
    Field('stored_energy', 'J', 'in accumulator and lines, more than at t = 0'),
    Field('held_energy', 'J', 'paid at pressures held over a tick, not given by a line'),
    Field('dump_opening', '1', 'of the dump valve: 0 shut, 1 open'),
    Field('gas_temperature', 'celsius', 'of an accumulator of a circuit; 0 of all else'),
    Field('oil_temperature', 'celsius', 'of a circuit whose tank has a heat; 0 of all else'),
    Field('heat', 'J', 'that its oil got of losses since t = 0; of tank and coolers: gave away'),
)
"""The sample of one supply at the end of a tick."""
SUPPLY_SAMPLE = record_type(SUPPLY_FIELDS)
SUPPLY_STATE = record_type(SUPPLY_FIELDS[:-3])
"""What a saved state has of it: a circuit has temperatures and heat in its own state."""
