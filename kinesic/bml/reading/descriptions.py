"""A behaviour's richer forms: its <description>s, of which the one with the highest priority counts that is understood.

What is understood: a behaviour of BML inside, which takes the place of the core form at the same times; expressivity,
and speech in a markup of its own, which go with the core form. When none is understood the core form stays.
"""

from collections.abc import Collection
from dataclasses import replace
from types import MappingProxyType

from kinesic.bml.reading.namespaces import is_core
from kinesic.bml.reading.tree import Element

WITH_THE_CORE = frozenset({"gretabml", "kinesic", "application/ssml+xml", "audio/x-wav", "audio/wav"})


def richest(element: Element, *, known: Collection[str], times: Collection[str], home: str | None) -> Element:
    """The form of a behaviour that is performed.

    Args:
        element: the behaviour, descriptions inside.
        known: local names of behaviours that are understood.
        times: attributes that say when, which stay those of the core form unless the richer one has its own.
        home: namespace of the <bml>.
    """
    described = [child for child in element.children if child.local == "description" and is_core(child, home=home)]
    for description in sorted(described, key=_priority, reverse=True):
        if description.attributes.get("type", "").strip().lower() in WITH_THE_CORE:
            return element
        inside = [child for child in description.children if child.local in known and is_core(child, home=home)]
        if len(inside) == 1:
            return _in_place(inside[0], element, times)
    return element


def _priority(description: Element) -> float:
    try:
        return float(description.attributes.get("priority", "0"))
    except ValueError:
        return 0.0


def _in_place(richer: Element, element: Element, times: Collection[str]) -> Element:
    """The richer form with the id of the core form, and its times."""
    kept = {name: value for name, value in element.attributes.items() if name == "id" or name in times}
    own = {name: value for name, value in richer.attributes.items() if name != "id"}
    return replace(richer, attributes=MappingProxyType({**kept, **own}))
