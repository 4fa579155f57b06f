"""Elements that other dialects write inside a <bml>, in BML's own words.

EMBR writes head movements as gestures; SmartBody's animations and body postures stand in a <bml>, too, and not only in
rows of fragments; names may be in capitals.
"""

from dataclasses import replace
from types import MappingProxyType

from kinesic.bml.reading.fragments import REWRITTEN
from kinesic.bml.reading.head_words import names_head_movement
from kinesic.bml.reading.tree import Element
from kinesic.bml.reading.vocabulary import AGENTS, ATTRIBUTES, BLOCK_ATTRIBUTES, INSIDE, SPOKEN

_NAMES = ("bml", "required", *ATTRIBUTES, *INSIDE, *SPOKEN)
_FOLDED = {name.lower(): name for name in _NAMES}
_ATTRIBUTES = {name.lower(): name for names in (BLOCK_ATTRIBUTES, AGENTS, *ATTRIBUTES.values()) for name in names}
_SMARTBODY = ("animation", "body")


def fold_capitals(element: Element, folded: set[str]) -> Element:
    """Rewrites names in capitals, <BML> or <SPEECH ID="s">, as BML has them.

    Args:
        element: with all that is in it.
        folded: gets the names of elements that were in capitals.
    """
    inside = tuple(piece if isinstance(piece, str) else fold_capitals(piece, folded) for piece in element.content)
    found = replace(element, content=inside)
    meant = _FOLDED.get(element.local.lower())
    if meant is None or not element.local.isupper():
        return found
    folded.add(element.name)
    prefix = element.name.removesuffix(element.local)
    renamed = {_ATTRIBUTES.get(name.lower(), name): value for name, value in element.attributes.items()}
    return replace(found, name=prefix + meant, attributes=MappingProxyType(renamed), called=element.name)


def in_own_words(element: Element) -> Element:
    """Rewrites a behaviour of another dialect as the one that it means; others stay."""
    if element.local == "gesture" and names_head_movement(_lexeme(element)):
        return element.reword("head")
    if element.local in _SMARTBODY:
        return REWRITTEN[element.local](element)
    return element


def _lexeme(element: Element) -> str:
    return element.attributes.get("lexeme", "").strip() or element.attributes.get("type", "").strip()
