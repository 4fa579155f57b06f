"""Reading of expressivity in Greta's descriptions and in the kinesic namespace.

Greta's values lie in -1 to 1, intensity in 0 to 1, openness in -0.7 to 1.13 (source: Greta's expressivity block and
lexicon); values outside are clipped with a notice. Kinesic's values are attributes (`kinesic:power="0.8"`) of a
behaviour or of the block, or elements inside `description type="kinesic"`; values outside are rejected.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import get_args

from kinesic.bml.block import EXPRESSIVITY_RANGES, Action, Manner, Modality, NoticeType, Place, find_modality
from kinesic.bml.reading.namespaces import select_kinesic_attributes
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading, read_finite
from kinesic.bml.reading.script import PAUSE_ATTRIBUTE
from kinesic.bml.reading.tree import Element
from kinesic.body.config import names_of, suggestion

GRETA_OPENNESS_RANGE = (-0.7, 1.13)  # smallest and largest openness in Greta's documents
REASON_ATTRIBUTE = "reason"  # attribute of the kinesic namespace: reason of a behaviour, for human readers

_GRETA_FIELD_NAMES = {  # element of a `gretabml` description -> expressivity parameter
    "SPC.value": "spatial",
    "TMP.value": "temporal",
    "FLD.value": "fluidity",
    "PWR.value": "power",
    "REP.value": "repetition",
    "OPN.value": "openness",
    "TEN.value": "tension",
    "intensity": "intensity",
}
GRETA_FIELDS = frozenset({"reference", *_GRETA_FIELD_NAMES})  # elements supported in a `gretabml` description
_GRETA_RANGES = {  # smallest and largest value in Greta's documents, by expressivity parameter
    **dict.fromkeys(_GRETA_FIELD_NAMES.values(), (-1.0, 1.0)),
    "openness": GRETA_OPENNESS_RANGE,
    "intensity": (0.0, 1.0),
}


def read_manner(node: BehaviourElement, action: Action, reading: DocumentReading) -> Manner:
    """Read the expressivity of a behaviour.

    kinesic's values override Greta's. Without any value in the document, the result is an empty Manner.

    Raises:
        BmlError: a value is not a finite number, or a kinesic value is out of range or has an unknown name.
    """
    entries = list(_read_entries(node.element))
    if entries and find_modality(action) is None:
        name, _, place = entries[0]
        problem = f"{name} in line {place.line} is ignored: no body part performs <{node.element.name}>"
        reading.add_notice(NoticeType.CUSTOM_ATTRIBUTE_NOT_SUPPORTED, problem, behaviour=node.id)
    manner = _read_greta(node, reading)
    for name, text, place in entries:
        manner = _set_field(manner, name, name.rpartition(":")[2], text, place, reading)
    return manner


def read_block_manners(bml: Element, reading: DocumentReading) -> dict[Modality, Manner]:
    """Read the expressivity of a block by modality.

    `power` applies to all modalities; `head.power` applies to one and overrides it.

    Raises:
        BmlError: an unknown name, or a value out of range.
    """
    manners: dict[Modality, Manner] = {}
    entries = [(name, name.rpartition(":")[2].rpartition("."), text, place) for name, text, place in _read_entries(bml)]
    for name, (part, _, parameter), text, place in sorted(entries, key=lambda entry: entry[1][1]):
        modalities = [modality for modality in get_args(Modality) if part in ("", modality)]
        if not modalities:
            raise reading.error(place, f"{name} is not a modality", suggestion(part, get_args(Modality))[2:])
        for modality in modalities:
            manners[modality] = _set_field(manners.get(modality, Manner()), name, parameter, text, place, reading)
    return manners


def read_reason(element: Element) -> str:
    """Return the text of `kinesic:reason`, or "" if it is missing."""
    entries = (
        text for name, text in select_kinesic_attributes(element).items() if name.rpartition(":")[2] == REASON_ATTRIBUTE
    )
    return " ".join(next(entries, "").split())


def scale_openness(greta: float) -> float:
    """Convert Greta's openness to the kinesic scale of 0 to 1.

    0 and below keeps the elbow at the body; 1.13 moves it far out.
    """
    return min(max(greta / GRETA_OPENNESS_RANGE[1], 0.0), 1.0)


def read_lexeme_reference(element: Element) -> str:
    """Return the lexeme named by a `gretabml` description, without its category.

    The result is empty if there is no such description.
    """
    description = _find_description(element, "gretabml")
    if description is None:
        return ""
    text = next((child.text for child in description.children if child.local == "reference"), "")
    return strip_category(text)


def strip_category(text: str) -> str:
    """Remove the category prefix from `category=id`."""
    return text.strip().rpartition("=")[2].strip()


def _read_greta(node: BehaviourElement, reading: DocumentReading) -> Manner:
    description = _find_description(node.element, "gretabml")
    values = {}
    for child in description.children if description is not None else ():
        name = _GRETA_FIELD_NAMES.get(child.local)
        if name is None or not child.text.strip():
            continue
        value = read_finite(child.text.strip(), child.local, child.place, reading)
        low, high = _GRETA_RANGES[name]
        values[name] = min(max(value, low), high)
        if values[name] != value:
            problem = f"{child.local} {value:g} is outside {low:g} to {high:g} and becomes {values[name]:g}"
            reading.add_notice(NoticeType.PARSING_FAILURE, problem, behaviour=node.id)
    if "openness" in values:
        values["openness"] = scale_openness(values["openness"])
    return Manner(style=None, **values)


def _read_entries(element: Element) -> Iterator[tuple[str, str, Place]]:
    """Yield name, value and place of an element's kinesic expressivity parameters.

    Attributes come last.
    """
    description = _find_description(element, "kinesic")
    for child in description.children if description is not None else ():
        yield child.name, child.text.strip(), child.place
    for name, text in select_kinesic_attributes(element).items():
        if name.rpartition(":")[2] not in (PAUSE_ATTRIBUTE, REASON_ATTRIBUTE):
            yield name, text.strip(), element.place


def _set_field(manner: Manner, name: str, parameter: str, text: str, place: Place, reading: DocumentReading) -> Manner:
    if parameter == "style":
        if text not in names_of("style"):
            raise reading.error(place, f"{name}='{text}' is not a style", suggestion(text, names_of("style"))[2:])
        return replace(manner, style=text)
    if parameter not in EXPRESSIVITY_RANGES:
        raise reading.error(
            place, f"{name} is not a parameter", suggestion(parameter, ["style", *EXPRESSIVITY_RANGES])[2:]
        )
    value = read_finite(text, name, place, reading)
    low, high = EXPRESSIVITY_RANGES[parameter]
    if not low <= value <= high:
        raise reading.error(place, f"{name}='{text}' is out of range", f"use {low:g} to {high:g}")
    return replace(manner, style=manner.style, **{parameter: value})


def _find_description(element: Element, kind: str) -> Element | None:
    for child in element.children:
        if child.local == "description" and child.attributes.get("type", "").strip().lower() == kind:
            return child
    return None
