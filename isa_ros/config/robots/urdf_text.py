"""
The text of a URDF: XML that says by itself all that it says.

A document type, and with it every entity, is refused, so that a file cannot expand; so are the
macros of xacro, which are not expanded here.
"""

from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from isa_ros.errors import ConfigError

_MACROS = 'xacro:'      # in front of its elements


def element_of(text: str | bytes, name: str) -> Element:
    """
    Return the element of a document; messages begin with ``name``.

    Raises
    ------
    ConfigError
        It is not XML, has a document type, or an element of xacro.

    """
    builder = TreeBuilder()
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def start(tag: str, attributes: dict[str, str]) -> Element:
        if tag.startswith(_MACROS):
            raise ConfigError(
                f'{name}: line {parser.CurrentLineNumber}: has <{tag}>, which is not read: '
                f'expand the file first, xacro {name} > robot.urdf')
        return builder.start(tag, attributes)

    def refuse(*declared: object) -> None:
        raise ConfigError(
            f'{name}: line {parser.CurrentLineNumber}: has a document type, <!DOCTYPE '
            f'{declared[0]}>, which is not read: a URDF has no entities')
    parser.StartElementHandler = start
    parser.EndElementHandler = builder.end
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise ConfigError(
            f'{name}: line {error.lineno}: is not XML: {expat.ErrorString(error.code)}') from error
    except (ValueError, LookupError) as error:  # its encoding
        raise ConfigError(f'{name}: is not XML: {error}') from error
    return builder.close()
