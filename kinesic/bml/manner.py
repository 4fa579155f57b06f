"""Greta's `description type="gretabml"`: expressivity, and a reference into its lexicon.

Values: facts on Greta's expressivity block (-1 to 1, intensity 0 to 1); what lies outside is clipped, with a notice.
"""

from kinesic.bml.block import Manner, NoticeType
from kinesic.bml.reading import Named, Reading, finite
from kinesic.bml.tree import Element

_FIELDS = {
    "SPC.value": "spatial",
    "TMP.value": "temporal",
    "FLD.value": "fluidity",
    "PWR.value": "power",
    "REP.value": "repetition",
    "OPN.value": "openness",
    "TEN.value": "tension",
    "intensity": "intensity",
}


def manner_of(named: Named, reading: Reading) -> Manner:
    """Reads the expressivity of a behaviour; an empty Manner when its document says nothing.

    Raises:
        BmlError: a value that is not a finite number.
    """
    description = _description(named.element)
    if description is None:
        return Manner()
    values = {}
    for child in description.children:
        name = _FIELDS.get(child.local)
        if name is None or not child.text.strip():
            continue
        value = finite(child.text.strip(), child.local, child.place, reading)
        lowest = 0.0 if name == "intensity" else -1.0
        values[name] = min(max(value, lowest), 1.0)
        if values[name] != value:
            what = f"{child.local} {value:g} is outside {lowest:g} to 1 and becomes {values[name]:g}"
            reading.note(NoticeType.PARSING_FAILURE, what, behaviour=named.id)
    return Manner(**values)


def reference_of(element: Element) -> str:
    """Lexeme that a description refers to, without its category; empty when there is none."""
    description = _description(element)
    if description is None:
        return ""
    written = next((child.text for child in description.children if child.local == "reference"), "")
    return lexeme(written)


def lexeme(written: str) -> str:
    """Id of `category=id`, or the whole."""
    return written.strip().rpartition("=")[2].strip()


def _description(element: Element) -> Element | None:
    for child in element.children:
        if child.local == "description" and child.attributes.get("type", "").strip().lower() == "gretabml":
            return child
    return None
