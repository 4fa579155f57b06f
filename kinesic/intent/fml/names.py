"""Names of FML intentions that no behaviour set is made for."""

from collections.abc import Iterable

from kinesic.body.config import suggestion
from kinesic.intent.behaviour_sets import BehaviourSets
from kinesic.intent.fml.intentions import DEFAULT_TYPE

ANY_TYPE = "*"  # type of the behaviour set that applies to all types of an element


def explain_unknown(name: str, sets: BehaviourSets) -> str:
    """Return why an intention's name is unknown, with names that would work.

    Empty if the name is known, or if its element has no types of its own.

    Args:
        name: element and type of the intention: `emotion-joy`.
        sets: behaviours by intention.
    """
    element, _, kind = name.partition("-")
    types_by_element = _group_types(sets.names)
    if element.lower() not in types_by_element:
        return f"element {element} is unknown{suggestion(element, list(types_by_element))}"
    types = types_by_element[element.lower()] - {ANY_TYPE}
    found = sets.find(name)
    is_own = found is not None and found.name.lower() != f"{element.lower()}-{ANY_TYPE}"
    if is_own or not types or kind == DEFAULT_TYPE:
        return ""
    return f"{element} has no type {kind}{suggestion(kind, list(types))}"


def _group_types(names: Iterable[str]) -> dict[str, set[str]]:
    """Return the types of each element, from names such as `emotion-joy`."""
    types: dict[str, set[str]] = {}
    for name in names:
        element, dash, kind = name.partition("-")
        if dash:
            types.setdefault(element.lower(), set()).add(kind)
    return types
