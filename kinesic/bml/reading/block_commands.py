"""Behaviours of extensions that act on other blocks: they are stopped, begun, or performed in another manner.

Elements: facts, BML 1.0 section 2.6; of ASAP's namespace and its predecessor's, in any case of their letters.
"""

import re
from collections.abc import Callable

from kinesic.bml.block import Action, Activate, Interrupt, ParameterChange
from kinesic.bml.reading.namespaces import is_composing
from kinesic.bml.reading.reader import BehaviourElement, DocumentReading
from kinesic.bml.reading.tree import Element

_VALUES = ("targetValue", "finalValue", "value")  # of a change, where it ends
_SEPARATOR = re.compile(r"[\s,]+")


def command_of(named: BehaviourElement, reading: DocumentReading) -> Action | None:
    """What an element does to other blocks; None when it is no such element.

    Raises:
        BmlError: it does not say to which block.
    """
    reads = _COMMANDS.get(named.element.local.lower())
    if reads is None or not is_composing(named.element.name, named.element):
        return None
    if not named.word("target"):
        what = f"<{named.element.name}> has no target"
        raise reading.refuse(named.element.place, what, "the id of a block is expected, such as target='bml1'")
    return reads(named)


def is_command(element: Element) -> bool:
    """Whether an element does something to other blocks."""
    return element.local.lower() in _COMMANDS and is_composing(element.name, element)


def _interrupt(named: BehaviourElement) -> Action:
    return Interrupt(named.word("target"), _ids(named.word("include")), _ids(named.word("exclude")))


def _activate(named: BehaviourElement) -> Action:
    return Activate(named.word("target"))


def _parameter_change(named: BehaviourElement) -> Action:
    inside = [named] + [BehaviourElement(named.id, child, child.attributes) for child in named.element.children]
    value = next((word for part in inside if (word := part.word(*_VALUES))), "")
    return ParameterChange(named.word("target"), named.word("paramId", "parameter", "name"), value)


_COMMANDS: dict[str, Callable[[BehaviourElement], Action]] = {
    "interrupt": _interrupt,
    "activate": _activate,
    "parametervaluechange": _parameter_change,
}


def _ids(text: str) -> tuple[str, ...]:
    return tuple(filter(None, _SEPARATOR.split(text)))
