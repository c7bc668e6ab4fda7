"""The book of docs: Sphinx, MyST and furo; made by `python -m scripts.build_docs`."""

from pathlib import Path
import runpy

_VERSION = runpy.run_path(str(Path(__file__).parents[1] / 'isa_ros' / 'core' / 'version.py'))

project = 'isa_ros'
copyright = 'isa_ros contributors, Apache License 2.0'  # noqa: A001, the name that Sphinx reads
release = _VERSION['VERSION']
html_title = f'isa_ros {release}'
extensions = ['myst_parser']
source_suffix = {'.md': 'markdown'}
root_doc = 'index'
html_theme = 'furo'
html_theme_options = {'footer_icons': []}
html_copy_source = html_show_sourcelink = False
myst_heading_anchors = 4
nitpicky = True
suppress_warnings: list[str] = []
