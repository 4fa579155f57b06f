"""Expressivity in documents: Greta's `description type="gretabml"`, and kinesic's own namespace.

Greta's values lie in -1 to 1, intensity in 0 to 1, openness in -0.7 to 1.13 (facts on Greta's expressivity block and
lexicon); what lies outside is clipped, with a notice. Ours are attributes (`kinesic:power="0.8"`) of a behaviour or of
the block, or elements inside `description type="kinesic"`; what lies outside is refused.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import get_args

from kinesic.bml.block import RANGES, Action, Manner, Modality, NoticeType, Place, modality_of
from kinesic.bml.reading.namespaces import own_attributes
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading, read_finite
from kinesic.bml.reading.script import PAUSE
from kinesic.bml.reading.tree import Element
from kinesic.body.config import names_of, suggestion

GRETA_OPENNESS = (-0.7, 1.13)
REASON = "reason"  # attribute of our namespace: why a behaviour is asked for, in words for people

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
GRETA_FIELDS = frozenset({"reference", *_FIELDS})  # elements that are read in a `gretabml` description
_GRETA_RANGES = {**dict.fromkeys(_FIELDS.values(), (-1.0, 1.0)), "openness": GRETA_OPENNESS, "intensity": (0.0, 1.0)}


def read_manner(named: BehaviourElement, action: Action, reading: DocumentReading) -> Manner:
    """Reads the expressivity of a behaviour, ours over Greta's; an empty Manner when its document says nothing.

    Raises:
        BmlError: a value that is not a finite number; of ours, also one out of range and an unknown name.
    """
    said = list(_said(named.element))
    if said and modality_of(action) is None:
        name, _, place = said[0]
        what = f"{name} in line {place.line} is passed over: no part of the body does <{named.element.name}>"
        reading.note(NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, what, behaviour=named.id)
    manner = _greta(named, reading)
    for name, text, place in said:
        manner = _set_field(manner, name, name.rpartition(":")[2], text, place, reading)
    return manner


def manners_of(bml: Element, reading: DocumentReading) -> dict[Modality, Manner]:
    """Reads what the block says of all its behaviours: `power` of all modalities, `head.power` of one, which wins.

    Raises:
        BmlError: an unknown name, or a value out of range.
    """
    manners: dict[Modality, Manner] = {}
    said = [(name, name.rpartition(":")[2].rpartition("."), text, place) for name, text, place in _said(bml)]
    for name, (part, _, parameter), text, place in sorted(said, key=lambda each: each[1][1]):
        modalities = [each for each in get_args(Modality) if part in ("", each)]
        if not modalities:
            raise reading.refuse(place, f"{name} names no modality", suggestion(part, get_args(Modality))[2:])
        for each in modalities:
            manners[each] = _set_field(manners.get(each, Manner()), name, parameter, text, place, reading)
    return manners


def reason_of(element: Element) -> str:
    """Reads `kinesic:reason`: why a behaviour is asked for; empty when its document does not say."""
    said = (text for name, text in own_attributes(element).items() if name.rpartition(":")[2] == REASON)
    return " ".join(next(said, "").split())


def openness_of(greta: float) -> float:
    """Converts Greta's openness to our scale: 0 and below is the elbow at the body, 1.13 an elbow far out."""
    return min(max(greta / GRETA_OPENNESS[1], 0.0), 1.0)


def reference_of(element: Element) -> str:
    """Reads the lexeme that a description refers to, without its category; empty when there is none."""
    description = _description(element, "gretabml")
    if description is None:
        return ""
    written = next((child.text for child in description.children if child.local == "reference"), "")
    return lexeme(written)


def lexeme(written: str) -> str:
    """Reads the id of `category=id`, or the whole."""
    return written.strip().rpartition("=")[2].strip()


def _greta(named: BehaviourElement, reading: DocumentReading) -> Manner:
    description = _description(named.element, "gretabml")
    values = {}
    for child in description.children if description is not None else ():
        name = _FIELDS.get(child.local)
        if name is None or not child.text.strip():
            continue
        value = read_finite(child.text.strip(), child.local, child.place, reading)
        least, most = _GRETA_RANGES[name]
        values[name] = min(max(value, least), most)
        if values[name] != value:
            what = f"{child.local} {value:g} is outside {least:g} to {most:g} and becomes {values[name]:g}"
            reading.note(NoticeType.PARSING_FAILURE, what, behaviour=named.id)
    if "openness" in values:
        values["openness"] = openness_of(values["openness"])
    return Manner(style=None, **values)


def _said(element: Element) -> Iterator[tuple[str, str, Place]]:
    """Yields name, value and place of all that our namespace says of an element, attributes last."""
    description = _description(element, "kinesic")
    for child in description.children if description is not None else ():
        yield child.name, child.text.strip(), child.place
    for name, text in own_attributes(element).items():
        if name.rpartition(":")[2] not in (PAUSE, REASON):
            yield name, text.strip(), element.place


def _set_field(manner: Manner, name: str, parameter: str, text: str, place: Place, reading: DocumentReading) -> Manner:
    if parameter == "style":
        if text not in names_of("style"):
            raise reading.refuse(place, f"{name}='{text}' is no style", suggestion(text, names_of("style"))[2:])
        return replace(manner, style=text)
    if parameter not in RANGES:
        raise reading.refuse(place, f"{name} is no parameter", suggestion(parameter, ["style", *RANGES])[2:])
    value = read_finite(text, name, place, reading)
    least, most = RANGES[parameter]
    if not least <= value <= most:
        raise reading.refuse(place, f"{name}='{text}' is out of range", f"{least:g} to {most:g} is allowed")
    return replace(manner, style=manner.style, **{parameter: value})


def _description(element: Element, kind: str) -> Element | None:
    for child in element.children:
        if child.local == "description" and child.attributes.get("type", "").strip().lower() == kind:
            return child
    return None
