"""The page beside other tools: a section for each row of its table, a source for each section."""

import re

from tests.docs.pages import text_of

PAGE = text_of('comparison')
TOOLS = ['Hopsan', 'Simscape', 'Modelica', 'Own code', 'Gazebo', 'Drake',
         'mujoco_ros2_control', "ros2_control's mock system",
         "ros2_canopen's fake slaves", 'HELICS', "PX4's lockstep", 'am-sdk',
         "KickCAT's simulator"]
_USED = re.compile(r'\]\[(\w+)\]')
_SOURCE = re.compile(r'^\[(\w+)\]: (https://\S+)$', re.MULTILINE)


def sections() -> dict[str, str]:
    """Return the text below each heading of the second level."""
    text = _SOURCE.sub('', PAGE)
    parts = re.split(r'^## (.+)\n', text, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def test_each_tool_has_a_row_and_a_section() -> None:
    rows = re.findall(r'^\| \[([^]]+)\]\(#([^)]+)\) \|', PAGE, re.MULTILINE)
    assert [name for name, _ in rows] == TOOLS == list(sections())[:-1]
    assert [anchor for _, anchor in rows] == [  # as MyST and GitHub make them of headings
        name.lower().replace("'", '').replace(' ', '-') for name in TOOLS]


def test_each_section_has_a_source_and_says_what_is_better_there() -> None:
    for tool in TOOLS:
        text = sections()[tool]
        assert _USED.search(text), tool
        assert '*Better there*: ' in text, tool


def test_each_source_is_used_and_is_a_page_or_a_file_at_a_commit() -> None:
    sources = dict(_SOURCE.findall(PAGE))
    assert set(sources) == set(_USED.findall(PAGE))
    assert len(set(sources.values())) == len(sources) > 20
    for address in sources.values():
        if address.startswith('https://github.com/'):
            assert re.search(r'/(blob|tree)/[0-9a-f]{40}/\w', address), address
