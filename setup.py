"""The only source of the package's metadata but its version: isa_ros/core/version.py."""

from pathlib import Path
import re
import sys

from setuptools import find_packages, setup

NAME = 'isa_ros'
ROOT = Path(__file__).parent

# setup.cfg puts console scripts where `ros2 run` looks; colcon adds PREFIX/bin to PATH. A wheel
# has an `isa` of its entry point, over which some installers would put this one.
IN_A_WORKSPACE = [] if 'bdist_wheel' in sys.argv else [('bin', ['bin/isa'])]


def shared(directory: str, pattern: str) -> tuple[str, list[str]]:
    """Return the data_files row that puts the matching files under share/isa_ros."""
    files = sorted((ROOT / directory).glob(pattern))
    return f'share/{NAME}/{directory}', [str(path.relative_to(ROOT)) for path in files]


def version() -> str:
    """Return the version, without importing what may not be installed yet."""
    text = (ROOT / NAME / 'core' / 'version.py').read_text(encoding='utf-8')
    found = re.search(r"^VERSION = '(.+)'$", text, re.MULTILINE)
    assert found is not None
    return found[1]


setup(
    name=NAME,
    version=version(),
    description='Hydraulic integrated smart actuators as ROS 2 nodes stepped in lockstep',
    long_description=(ROOT / 'README.md').read_text(encoding='utf-8')
    if (ROOT / 'README.md').exists() else '',
    long_description_content_type='text/markdown',
    maintainer='isa_ros maintainers',
    maintainer_email='isa_ros@users.noreply.github.com',
    license='Apache-2.0 AND MIT',    # MIT: uPlot, in isa_ros/vendor
    license_files=['LICENSE', 'isa_ros/vendor/*/LICENSE'],
    python_requires='>=3.10',
    packages=find_packages(include=['isa_ros', 'isa_ros.*', 'msg_adapters', 'msg_adapters.*']),
    package_data={
        'isa_ros': [
            'kernels/*.so',
            'py.typed', 'analysis/report/browser/*', 'config/data/*/*.yaml', 'export/sources/*',
            'export/fmi/sources/*', 'nodes/middleware/*.xml', 'paper/*.yaml', 'vendor/*.json',
            'vendor/*/*', 'view/browser/*'],
        'msg_adapters': ['py.typed'],
    },
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (f'share/{NAME}', ['package.xml']),
        *IN_A_WORKSPACE,
        shared('config', '*.yaml'),
        shared('config/bad', '*.yaml'),
        shared('config/controllers', '*.yaml'),
        shared('config/measurements', '*.yaml'),
        shared('config/scenarios', '*.yaml'),
        shared('launch', '*.launch.py'),
        shared('layouts', '*.*'),
        shared('rviz', '*.rviz'),
        shared('urdf', '*.urdf'),
    ],
    # The ROS wheels never stand here: a machine with apt's ROS must not pull them.
    install_requires=[
        'lz4>=4.0',
        'matplotlib>=3.6',
        'mcap>=1.1',
        'numba>=0.58',
        'numpy>=1.26',
        'pillow>=9.0',  # matplotlib's own; figures of the studies are saved with a palette
        'PyYAML>=6.0',
        'scipy>=1.11',
        'zstandard>=0.19',
    ],
    extras_require={    # one a door to other programs, in docs/installing.md
        'canopen': ['canopen>=2.3', 'msgpack>=1.0', 'python-can>=4.3'],
        'ethercat': ['pysoem>=1.1'],    # the master of isa_ros.examples.ethercat_master
        'mujoco': ['mujoco>=3.2'],  # another simulator as the body of a run
        'pinocchio': ['pin>=3.0'],  # of the example isa_ros.examples.pinocchio_crane
        'test': ['hypothesis', 'pytest']},
    zip_safe=False,
    entry_points={
        'console_scripts': [
            'actuator = isa_ros.programs.actuator:main',
            'isa_v2 = isa_ros.programs.actuator:isa_v2',
            'isa_v5 = isa_ros.programs.actuator:isa_v5',
            'smart_manifold = isa_ros.programs.actuator:smart_manifold',
            'coordinator = isa_ros.programs.coordinator:main',
            'isa = isa_ros.programs.isa:main',
        ],
    },
)
