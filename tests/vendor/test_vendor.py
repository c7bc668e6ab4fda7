"""Code of others: as its author published it, and with its licence wherever it goes."""

import base64
import hashlib
import json
from pathlib import Path
import re

from isa_ros import vendor
from isa_ros.vendor import uplot

ROOT = Path(__file__).parents[2]
FOLDER = Path(vendor.__file__).parent
MANIFEST = json.loads((FOLDER / 'manifest.json').read_text(encoding='utf-8'))


def test_files_are_those_of_the_manifest():
    """No other file, and each with the bytes that were checked against the registry's archive."""
    assert set(MANIFEST) == {path.name for path in FOLDER.iterdir()
                             if path.is_dir() and not path.name.startswith('__')}
    for name, entry in MANIFEST.items():
        found = {path.name: 'sha384-' + base64.b64encode(
            hashlib.sha384(path.read_bytes()).digest()).decode()
            for path in (FOLDER / name).iterdir()}
        assert found == entry['files']
        assert re.fullmatch(r'sha512-[A-Za-z0-9+/]{86}==', entry['integrity'])


def test_the_version_is_that_of_the_script():
    assert f'(v{MANIFEST["uplot"]["version"]})' in uplot().script[:100]
    assert uplot().style.startswith('.uplot')


def test_the_licence_is_told_where_the_package_is_described():
    """In its metadata for pip and ROS, and on the page of licences."""
    assert 'The MIT License' in uplot().licence == (
        FOLDER / 'uplot' / 'LICENSE').read_text()
    assert "license='Apache-2.0 AND MIT'" in (ROOT / 'setup.py').read_text()
    assert '<license file="isa_ros/vendor/uplot/LICENSE">MIT</license>' in (
        ROOT / 'package.xml').read_text()
    assert 'uPlot' in (ROOT / 'docs' / 'licences.md').read_text()
