"""Translation of other dialects' elements inside a <bml> into BML elements.

EMBR writes head movements as gestures. SmartBody's animations and body postures may also stand in a <bml>. Names may be
in capitals.
"""

from dataclasses import replace
from types import MappingProxyType

from kinesic.bml.reading.fragments import SMARTBODY_REWRITERS
from kinesic.bml.reading.head_words import names_head_movement
from kinesic.bml.reading.tree import Element
from kinesic.bml.reading.vocabulary import (
    AGENT_ATTRIBUTES,
    BEHAVIOUR_ATTRIBUTES,
    BLOCK_ATTRIBUTES,
    NESTED_ATTRIBUTES,
    SPEECH_ATTRIBUTES,
)

# names of supported BML elements
_CORE_NAMES = ("bml", "required", *BEHAVIOUR_ATTRIBUTES, *NESTED_ATTRIBUTES, *SPEECH_ATTRIBUTES)
_NAMES_BY_LOWERCASE = {name.lower(): name for name in _CORE_NAMES}  # element name in lower case -> in BML's spelling
_ATTRIBUTES_BY_LOWERCASE = {  # attribute in lower case -> in BML's spelling
    name.lower(): name
    for names in (BLOCK_ATTRIBUTES, AGENT_ATTRIBUTES, *BEHAVIOUR_ATTRIBUTES.values())
    for name in names
}
_SMARTBODY_BEHAVIOURS = ("animation", "body")  # SmartBody elements that are accepted inside a <bml>


def fold_capitals(element: Element, folded: set[str]) -> Element:
    """Convert element names in capitals, such as <SPEECH>, to BML's spelling.

    Args:
        element: element with its content.
        folded: receives the names of elements in capitals.
    """
    content = tuple(piece if isinstance(piece, str) else fold_capitals(piece, folded) for piece in element.content)
    folded_element = replace(element, content=content)
    core_name = _NAMES_BY_LOWERCASE.get(element.local.lower())
    if core_name is None or not element.local.isupper():
        return folded_element
    folded.add(element.name)
    prefix = element.name.removesuffix(element.local)
    renamed = {_ATTRIBUTES_BY_LOWERCASE.get(name.lower(), name): value for name, value in element.attributes.items()}
    return replace(
        folded_element, name=prefix + core_name, attributes=MappingProxyType(renamed), original_tag=element.name
    )


def translate_dialect(element: Element) -> Element:
    """Translate a behaviour of another dialect into the equivalent BML element.

    Other elements are returned unchanged.
    """
    if element.local == "gesture" and names_head_movement(_lexeme(element)):
        return element.reword("head")
    if element.local in _SMARTBODY_BEHAVIOURS:
        return SMARTBODY_REWRITERS[element.local](element)
    return element


def _lexeme(element: Element) -> str:
    return element.attributes.get("lexeme", "").strip() or element.attributes.get("type", "").strip()
