"""
Provenance of a bag: everything that a replay needs, stored in the bag itself.

It has no data of the host: no wall time, path, user, process mode or number of processes.
"""

from collections.abc import Mapping
from dataclasses import field
import hashlib
from importlib.metadata import version
import platform

from isa_ros.core.frozen import frozen
from isa_ros.core.version import VERSION as OWN_VERSION
from isa_ros.errors import BagError

CONFIGURATION = 'configuration.yaml'
SCENARIO = 'scenario.yaml'
STATE = 'state.json'
MEDIA_TYPES = {
    CONFIGURATION: 'application/yaml', SCENARIO: 'application/yaml', STATE: 'application/json'}
RECORD = 'isa_ros'
FORMAT = '1'

VERSION = 'version.'
BODY = 'body.'
"""Begins what external bodies say of themselves: BODY.NAME.KEY."""
PYTHON = 'python'
KERNELS = 'kernels'
"""Among the versions: a digest of the kernels of a tick (`isa_ros.run.provenance`)."""
_RESULT_DEPENDS_ON = ('llvmlite', 'numba', 'numpy')


@frozen
class Provenance:
    """Resolved configuration, scenario (YAML texts), seed, and versions by package name."""

    configuration: str
    scenario: str
    seed: int
    versions: Mapping[str, str]
    state: str | None = None
    """The saved state that the run continued from (JSON text); None: it began at t = 0."""
    bodies: Mapping[str, str] = field(default_factory=dict)
    """What external bodies say of themselves, by BODY.KEY: their simulator, its version."""

    def attachments(self) -> dict[str, bytes]:
        """Return the attachments by name."""
        always = {CONFIGURATION: self.configuration.encode(), SCENARIO: self.scenario.encode()}
        return always if self.state is None else always | {STATE: self.state.encode()}

    def record(self) -> dict[str, str]:
        """Return the key-value metadata record, in fixed order."""
        digests = {f'{name}.sha256': _sha256(data) for name, data in self.attachments().items()}
        versions = {f'{VERSION}{name}': self.versions[name] for name in sorted(self.versions)}
        bodies = {f'{BODY}{name}': self.bodies[name] for name in sorted(self.bodies)}
        return {'format': FORMAT, 'seed': str(self.seed), **digests, **versions, **bodies}

    @classmethod
    def of_records(
            cls, attachments: Mapping[str, bytes], record: Mapping[str, str],
            where: str) -> 'Provenance':
        """
        Return the provenance of a bag; inverse of `attachments` and `record`.

        Raises
        ------
        BagError
            A part is missing, altered, or of a later format.

        """
        if record.get('format') != FORMAT:
            raise BagError(
                f'{where}: provenance format {record.get("format")!r}, must be {FORMAT!r}')
        has_state = STATE in attachments or f'{STATE}.sha256' in record
        expected = (CONFIGURATION, SCENARIO, *((STATE,) if has_state else ()))
        for name in expected:
            if name not in attachments:
                raise BagError(f'{where}: attachment {name} is missing')
            if record.get(f'{name}.sha256') != _sha256(attachments[name]):
                raise BagError(f'{where}: attachment {name} does not match its sha256')
            _refuse_undecodable(name, attachments[name], where)
        try:
            seed = int(record.get('seed', ''))
        except ValueError:
            raise BagError(f'{where}: seed {record.get("seed")!r}, must be an integer') from None
        return cls(
            configuration=attachments[CONFIGURATION].decode(),
            scenario=attachments[SCENARIO].decode(),
            seed=seed,
            versions=versions_of(record),
            state=attachments[STATE].decode() if has_state else None,
            bodies={key.removeprefix(BODY): value for key, value in record.items()
                    if key.startswith(BODY)})


def _refuse_undecodable(name: str, data: bytes, where: str) -> None:
    try:
        data.decode()
    except UnicodeDecodeError as error:
        raise BagError(f'{where}: attachment {name}: byte {error.start} is not UTF-8') from None


def installed_versions() -> dict[str, str]:
    """
    Return the versions of the packages that a run's numbers depend on, by name.

    Of Python without the patch release, which changes no number.
    """
    versions = {name: version(name) for name in _RESULT_DEPENDS_ON}
    python = without_patch(platform.python_version())
    return {'isa_ros': OWN_VERSION, PYTHON: python, **versions}


def versions_of(record: Mapping[str, str]) -> dict[str, str]:
    """Return the versions in a bag's record, by name."""
    return {key.removeprefix(VERSION): value
            for key, value in record.items() if key.startswith(VERSION)}


def have_comparable_kernels(versions: Mapping[str, str], others: Mapping[str, str]) -> bool:
    """
    Return whether different digests of kernels mean different equations.

    Earlier bags have no digest, and each minor release of Python has its own.
    """
    pythons = {without_patch(each.get(PYTHON, '')) for each in (versions, others)}
    return KERNELS in versions and KERNELS in others and len(pythons) == 1


def without_patch(version_: str) -> str:
    """Return major and minor release of a version."""
    return '.'.join(version_.split('.')[:2])


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
