"""The directory of an export: nothing of a user is overwritten."""

import json
from pathlib import Path

from isa_ros.errors import ConfigError
from isa_ros.export.directory import LIST, refuse_foreign, write
import pytest

FILES = {'one.h': b'header', 'lib.so': b'\x7fELF'}


def test_files_and_their_list(tmp_path):
    out = tmp_path / 'a' / 'b'
    write(out, FILES)
    assert {path.name: path.read_bytes() for path in out.iterdir() if path.name != LIST} == FILES
    tree = json.loads((out / LIST).read_text())
    assert sorted(tree['files']) == sorted(FILES) and len(tree['files']['one.h']) == 64


def test_an_earlier_export_is_replaced_and_other_files_stay(tmp_path):
    write(tmp_path, FILES)
    (tmp_path / 'example').write_bytes(b'built')
    write(tmp_path, {'one.h': b'another', 'two.h': b'second'})
    assert (tmp_path / 'one.h').read_bytes() == b'another'
    assert (tmp_path / 'lib.so').read_bytes() == FILES['lib.so']
    assert (tmp_path / 'example').read_bytes() == b'built'
    assert sorted(json.loads((tmp_path / LIST).read_text())['files']) == [
        'lib.so', 'one.h', 'two.h']
    write(tmp_path, FILES)
    assert (tmp_path / 'one.h').read_bytes() == b'header'


def refused(out, match):
    """Assert that nothing is written to a directory."""
    before = {path: path.read_bytes() for path in out.iterdir()} if out.is_dir() else out
    for act in (write, refuse_foreign):
        with pytest.raises(ConfigError, match=match):
            act(out, FILES)
    assert before == ({path: path.read_bytes() for path in out.iterdir()}
                      if out.is_dir() else out)


def test_foreign_files(tmp_path):
    (tmp_path / 'notes.txt').write_text('mine')
    refused(tmp_path, r'has files that are not of an export, such as notes\.txt; nothing is '
                      'written, must be a new or empty directory$')


def test_files_that_were_changed(tmp_path):
    write(tmp_path, FILES)
    (tmp_path / 'one.h').write_text('headed')
    refused(tmp_path, r'one\.h is not as it was exported; nothing is written')


def test_files_beside_an_export_that_have_its_names(tmp_path):
    write(tmp_path, {'two.h': b'second'})
    (tmp_path / 'lib.so').write_text('mine')
    refused(tmp_path, r'lib\.so is not as it was exported')


@pytest.mark.parametrize('text', ['', '[]', '{}', '{"files": 3}', '{"files": ["one.h"]}', '{'])
def test_a_list_that_is_none(tmp_path, text):
    (tmp_path / LIST).write_text(text)
    refused(tmp_path, rf'{LIST}: is not the list of an export; nothing is written$')


def test_a_file_is_no_directory(tmp_path):
    (tmp_path / 'file').write_text('mine')
    refused(tmp_path / 'file', 'file is a file, must be a directory$')


def test_what_cannot_be_written(tmp_path):
    (tmp_path / 'out').mkdir()
    with pytest.raises(ConfigError, match='one.h: cannot be written, '):
        write(tmp_path / 'out', {'below/one.h': b''})


def test_a_directory_that_takes_no_file(tmp_path):
    """As /proc, whose permissions allow it; nothing is left in one that does."""
    refused(Path('/proc/none/out'), '^/proc/none/out: cannot be written, ')
    refuse_foreign(tmp_path / 'a' / 'b', FILES)
    assert list(tmp_path.iterdir()) == []
