"""Prosody tags in a text: rate, pitch and volume of the voice."""

import re
from collections.abc import Mapping

from kinesic.intent.markup import quote

PROSODY_TAG = "kinesic:prosody"  # name of the tag around words with a requested prosody
VOICE_TAG = "kinesic:voice"  # name of the tag that sets the voice until the next such tag
PROSODY_ATTRIBUTES = ("rate", "pitch", "range", "volume")  # attributes that the voice follows
MAX_OPEN_ELEMENTS = 16  # largest depth of nested prosody elements; deeper elements are ignored
_ATTRIBUTE_PATTERN = re.compile(r'(\w+)="([^"<>]*)"')
_VALUE_PATTERN = re.compile(r"[+-]?\d{1,4}(?:\.\d{1,3})?\s?(?:%|st|Hz|dB)?|[a-z]{3,7}|x-[a-z]{3,6}", re.IGNORECASE)

Prosody = tuple[tuple[str, str], ...]  # attributes of one element
Layers = tuple[Prosody, ...]  # settings of the voice, then the prosody of each open element

NO_LAYERS: Layers = ((),)  # prosody of text without prosody elements


def write_tag(tag: str, attributes: Mapping[str, str], *, is_alone: bool = False) -> str:
    """Return a tag with its valid prosody attributes, empty text without attributes.

    A tag that stands alone is also written without attributes.
    """
    valid = {name: attributes[name].strip() for name in PROSODY_ATTRIBUTES if name in attributes}
    written = "".join(f" {name}={quote(value)}" for name, value in valid.items() if _VALUE_PATTERN.fullmatch(value))
    return f"<{tag}{written}{'/' * is_alone}>" if written or is_alone else ""


def take_tag(layers: Layers, name: str, tag: str, *, is_end: bool) -> Layers:
    """Return the stack of open prosody elements after a tag."""
    attributes = tuple(_ATTRIBUTE_PATTERN.findall(tag))
    if name == VOICE_TAG:
        settings = dict(layers[0]) | dict(attributes) if attributes else {}
        return (tuple(settings.items()), *layers[1:])
    if is_end:
        return layers[:-1] if len(layers) > 1 else layers
    return (*layers, attributes) if len(layers) <= MAX_OPEN_ELEMENTS else layers


def merge_prosody(layers: Layers) -> Prosody:
    """Merge the attributes of all open elements, inner ones overriding outer."""
    return tuple({name: value for layer in layers for name, value in layer}.items())


def reopen(layers: Layers) -> str:
    """Return the tags that reopen all open prosody elements."""
    settings = write_tag(VOICE_TAG, dict(layers[0]), is_alone=True) if layers[0] else ""
    return settings + "".join(write_tag(PROSODY_TAG, dict(layer)) or f"<{PROSODY_TAG}>" for layer in layers[1:])
