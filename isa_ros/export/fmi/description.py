"""modelDescription.xml of a unit, for FMI 2.0 and FMI 3.0."""

from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from typing import NamedTuple
from xml.etree import ElementTree as xml

from isa_ros.core.units import in_si
from isa_ros.core.version import VERSION
from isa_ros.export.fmi.variables import ENUMERATIONS, Type, UnitRole, Variable


class Version(Enum):
    """A version of FMI."""

    FMI2 = '2.0'
    FMI3 = '3.0'


class About(NamedTuple):
    """What the description says of the unit as a whole."""

    name: str
    """Of the actuator in its run."""
    identifier: str
    """Name of the library, a word of C."""
    token: str
    """Equal for units that have the same variables, parameters and kernels."""
    meaning: str
    step: float
    """The tick, s."""


CATEGORIES = {
    'logStatusWarning': 'a value that was refused or limited; the step goes on without it',
    'logStatusDiscard': 'a number that is not finite; the value before stays',
    'logStatusError': 'a call that is not possible, as a step that is not of whole ticks, or a '
                      'state that is no longer finite'}
"""Meaning of each category of messages."""
TYPES = {Type.REAL: 'Real', Type.INTEGER: 'Integer', Type.BOOLEAN: 'Boolean',
         Type.TEXT: 'String', Type.ENUMERATION: 'Enumeration'}
TYPES_OF_3 = {**TYPES, Type.REAL: 'Float64', Type.INTEGER: 'Int32'}
_CAUSALITY = {UnitRole.TIME: 'independent', UnitRole.INPUT: 'input', UnitRole.OUTPUT: 'output',
              UnitRole.START: 'parameter', UnitRole.TUNED: 'parameter', UnitRole.CONSTANT: 'local'}
_BASE: Mapping[str, Mapping[str, float]] = {
    'm': {'m': 1}, 's': {'s': 1}, 'kg': {'kg': 1}, 'A': {'A': 1}, 'K': {'K': 1},
    'rad': {'rad': 1}, 'Hz': {'s': -1}, 'celsius': {'K': 1, 'offset': 273.15},
    'm/s': {'m': 1, 's': -1}, 'm/s2': {'m': 1, 's': -2}, 'm/s3': {'m': 1, 's': -3},
    'rad/s': {'rad': 1, 's': -1}, 'rad/s2': {'rad': 1, 's': -2}, 'rad/s3': {'rad': 1, 's': -3},
    '1/s': {'s': -1}, '1/s2': {'s': -2}, '1/kg': {'kg': -1},
    '1/(kg m2)': {'kg': -1, 'm': -2}, 'kg m2': {'kg': 1, 'm': 2},
    'N': {'kg': 1, 'm': 1, 's': -2}, 'Nm': {'kg': 1, 'm': 2, 's': -2},
    'N/m': {'kg': 1, 's': -2}, 'Nm/rad': {'kg': 1, 'm': 2, 's': -2, 'rad': -1},
    'Ns/m': {'kg': 1, 's': -1}, 'Nms/rad': {'kg': 1, 'm': 2, 's': -1, 'rad': -1},
    'Pa': {'kg': 1, 'm': -1, 's': -2}, 'm3': {'m': 3}, 'm3/s': {'m': 3, 's': -1},
    'm3/s/Pa': {'m': 4, 's': 1, 'kg': -1},
    'J': {'kg': 1, 'm': 2, 's': -2}, 'W': {'kg': 1, 'm': 2, 's': -3}}
"""Powers of the base units; other units of parameters have a name only."""


def description(about: About, table: Sequence[Variable], version: Version) -> bytes:
    """Return the text of modelDescription.xml."""
    is_3 = version is Version.FMI3
    root = xml.Element('fmiModelDescription', {
        'fmiVersion': version.value, 'modelName': about.name,
        'instantiationToken' if is_3 else 'guid': about.token, 'description': about.meaning,
        'version': VERSION, 'license': 'Apache-2.0',
        'generationTool': f'isa_ros {VERSION}',
        'variableNamingConvention': 'structured',
        **({} if is_3 else {'numberOfEventIndicators': '0'})})
    state = 'State' if is_3 else 'state'
    xml.SubElement(root, 'CoSimulation', {
        'modelIdentifier': about.identifier, 'canHandleVariableCommunicationStepSize': 'true',
        f'canGetAndSetFMU{state}': 'true', f'canSerializeFMU{state}': 'true',
        **({'fixedInternalStepSize': _text(about.step)} if is_3 else {})})
    _write_units(xml.SubElement(root, 'UnitDefinitions'), table)
    _write_types(xml.SubElement(root, 'TypeDefinitions'), is_3)
    categories = xml.SubElement(root, 'LogCategories')
    for name, meaning in CATEGORIES.items():
        xml.SubElement(categories, 'Category', name=name, description=meaning)
    xml.SubElement(root, 'DefaultExperiment', startTime='0', stopTime='1',
                   stepSize=_text(about.step))
    owner = xml.SubElement(root, 'ModelVariables')
    for reference, own in enumerate(table):
        if is_3:
            _write_of_3(owner, reference, own)
        elif own.role is not UnitRole.TIME:     # not needed there, and importers stumble over it
            _write_of_2(owner, reference, own)
    _write_structure(xml.SubElement(root, 'ModelStructure'), table, is_3)
    xml.indent(root)
    text: bytes = xml.tostring(root, encoding='UTF-8', xml_declaration=True)
    return text


def _text(value: float | str | bool) -> str:
    """Return a value as XML has it; a number with all its digits."""
    return value if isinstance(value, str) else repr(value)


def _start(own: Variable) -> str:
    if own.kind is Type.BOOLEAN:
        return 'true' if own.start else 'false'
    if own.kind in (Type.INTEGER, Type.ENUMERATION) and isinstance(own.start, float):
        return str(int(own.start))
    return '' if own.start is None else _text(own.start)


def _unit(own: Variable) -> str | None:
    is_number = own.kind is Type.REAL and own.unit not in ('', '1')
    return own.unit if is_number else None


def _variability(own: Variable) -> str:
    of_parameters = {
        UnitRole.CONSTANT: 'constant', UnitRole.START: 'fixed', UnitRole.TUNED: 'tunable'}
    return of_parameters.get(own.role) or (
        'continuous' if own.kind is Type.REAL else 'discrete')


def _initial(own: Variable) -> dict[str, str]:
    """Return the attribute ``initial``, which time and inputs have not."""
    if own.role in (UnitRole.TIME, UnitRole.INPUT):
        return {}
    return {'initial': 'calculated' if own.role is UnitRole.OUTPUT else 'exact'}


def _of_value(own: Variable, kind: str) -> dict[str, str]:
    """Return the attributes of a value: type, unit, range and start."""
    found = {}
    if kind:
        found['declaredType'] = kind
    if unit := _unit(own):
        found['unit'] = unit
    if own.kind is not Type.BOOLEAN:
        found |= {key: _bound(own, bound) for key, bound in (('min', own.low), ('max', own.high))
                  if bound is not None}
    return found


def _bound(own: Variable, bound: float) -> str:
    return _text(bound) if own.kind is Type.REAL else str(int(bound))


def _write_of_2(owner: xml.Element, reference: int, own: Variable) -> None:
    element = xml.SubElement(owner, 'ScalarVariable', {
        'name': own.name, 'valueReference': str(reference), 'description': own.meaning,
        'causality': _CAUSALITY[own.role], 'variability': _variability(own), **_initial(own)})
    value = _of_value(own, own.enumeration)
    if own.start is not None:
        value['start'] = _start(own)
    xml.SubElement(element, TYPES[own.kind], value)


def _write_of_3(owner: xml.Element, reference: int, own: Variable) -> None:
    is_text = own.kind is Type.TEXT
    element = xml.SubElement(owner, TYPES_OF_3[own.kind], {
        'name': own.name, 'valueReference': str(reference), 'description': own.meaning,
        'causality': _CAUSALITY[own.role], 'variability': _variability(own), **_initial(own),
        **_of_value(own, own.enumeration),
        **({} if own.start is None or is_text else {'start': _start(own)})})
    if is_text:
        xml.SubElement(element, 'Start', value=_start(own))


def _write_units(owner: xml.Element, table: Sequence[Variable]) -> None:
    for name in sorted({unit for own in table if (unit := _unit(own))}):
        element = xml.SubElement(owner, 'Unit', name=name)
        base = _base(name)
        if base is not None:
            xml.SubElement(element, 'BaseUnit', base)


def _base(name: str) -> dict[str, str] | None:
    """Return the attributes of the unit in base units, None: they are not known."""
    known = _BASE.get(name)
    if known is not None:
        return {key: str(power) for key, power in known.items()}
    try:
        found = in_si(name)
    except ValueError:
        return None
    known = _BASE.get(found.si)
    if known is None:
        return None
    return {key: str(power) for key, power in known.items()} | {'factor': repr(found.scale)}


def _write_types(owner: xml.Element, is_3: bool) -> None:
    for name, items in ENUMERATIONS.items():
        element = (xml.SubElement(owner, 'EnumerationType', name=name) if is_3 else
                   xml.SubElement(xml.SubElement(owner, 'SimpleType', name=name), 'Enumeration'))
        for number, item in enumerate(items):
            xml.SubElement(element, 'Item', name=item, value=str(number))


def _write_structure(owner: xml.Element, table: Sequence[Variable], is_3: bool) -> None:
    """Write the outputs, which depend on all inputs of earlier steps and of none of this one."""
    found = list(_outputs(table))
    if is_3:
        for tag in ('Output', 'InitialUnknown'):
            for reference in found:
                xml.SubElement(owner, tag, valueReference=str(reference))
        return
    for tag in ('Outputs', 'InitialUnknowns'):
        element = xml.SubElement(owner, tag)
        for reference in found:
            xml.SubElement(element, 'Unknown', index=str(reference + 1))


def _outputs(table: Sequence[Variable]) -> Iterator[int]:
    for reference, own in enumerate(table):
        if own.role is UnitRole.OUTPUT:
            yield reference
