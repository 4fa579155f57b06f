"""Reads a lexicon of intentions of Greta: behaviour sets with core, alternatives, implications and sequences."""

import re
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from kinesic.bml.reading.manner import lexeme
from kinesic.bml.reading.tree import Element
from kinesic.body.config import ConfigError
from kinesic.intent.behaviour_sets import (
    DIRECTIONS,
    BehaviourSet,
    BehaviourSets,
    Channel,
    Choice,
    Implication,
    Signal,
    Spell,
    own_sets,
)
from kinesic.intent.greta.files import number_of, read_root

CHANNELS: dict[str, Channel] = {
    "gesture": "gesture",
    "pointing": "gesture",
    "head": "head",
    "face": "face",
    "gaze": "gaze",
    "torso": "torso",
    "shoulder": "torso",
}
SEQUENCE = "mse"  # type of a set whose signals follow one another
POINTING = "this_index"  # gesture of a signal that only says the shape of a pointing hand
LASTS = (1.0, 3.0)  # [s] of a signal in a sequence that does not say

_PART = re.compile(r"_signal_\d+$", re.IGNORECASE)  # of an expression that is seen in stages
_LOOK = re.compile(r"^look_", re.IGNORECASE)
_HEADS = {  # head movements that BML has no word for -> lexeme, amount
    "nod_big": ("NOD", 0.9),
    "nod_middle": ("NOD", 0.5),
    "nod_small": ("NOD", 0.25),
    "nod1": ("NOD", 0.5),
    "nodupdown": ("NOD", 0.5),
    "noddownup": ("NOD", 0.5),
    "shake_big": ("SHAKE", 0.9),
    "shake_middle": ("SHAKE", 0.5),
    "shake_small": ("SHAKE", 0.25),
    "shake1": ("SHAKE", 0.5),
    "shakeleftright": ("SHAKE", 0.5),
    "shakerightleft": ("SHAKE", 0.5),
}


@lru_cache(maxsize=8)
def read_lexicon(path: Path) -> BehaviourSets:
    """Reads a lexicon; what it does not have is taken from kinesic's own sets.

    Raises:
        ConfigError: there is no such file, or it is no lexicon of intentions.
    """
    root = read_root(path, "behaviorsets")
    sets = [_behaviour_set(each, path) for each in root.children if each.local == "behaviorset"]
    return BehaviourSets({each.name: each for each in sets}, beside=own_sets())


def _behaviour_set(element: Element, path: Path) -> BehaviourSet:
    name = element.attributes.get("name", "").strip()
    if not name:
        raise ConfigError(f"{path}:{element.place.line}: a behaviorset without a name")
    inside = {each.local: each for each in element.children}
    is_sequence = element.attributes.get("type", "").strip().lower() == SEQUENCE
    signals = inside["signals"].children if "signals" in inside else ()
    constraints = inside["constraints"].children if "constraints" in inside else ()
    core = [item for each in constraints if each.local == "core" for item in each.children]
    rules = [rule for each in constraints if each.local == "rules" for rule in each.children]
    return BehaviourSet(
        name,
        tuple(found for each in signals for found in [_signal(each, path, is_sequence)] if found),
        frozenset(item.attributes.get("id", "") for item in core),
        tuple(found for rule in rules for found in _implications(rule)),
    )


def _signal(element: Element, path: Path, is_sequence: bool) -> Signal | None:
    """A signal; None for a part of the body that kinesic does not move."""
    modality = element.attributes.get("modality", "").strip().lower()
    if modality not in CHANNELS:
        return None
    channel = CHANNELS[modality]
    others = [
        (each, number_of(each, "probability", path, 0.0)) for each in element.children if each.local == "alternative"
    ]
    rest = max(0.0, 1.0 - sum(share for _, share in others))
    choices = [_choice(element, channel, rest), *(_choice(each, channel, share) for each, share in others)]
    if modality == "pointing":
        choices = [Choice(POINTING, 1.0)]
    return Signal(
        element.attributes.get("id", ""),
        channel,
        tuple(choices),
        _spell(element, path) if is_sequence else None,
    )


def _spell(element: Element, path: Path) -> Spell:
    excluded = element.attributes.get("excludelist", "").split(",")
    return Spell(
        number_of(element, "min", path, LASTS[0]),
        number_of(element, "max", path, LASTS[1]),
        number_of(element, "probability_start", path, 0.5),
        number_of(element, "probability_end", path, 0.5),
        repeats=number_of(element, "repetitivity", path, 0.0) > 0.0,
        name=lexeme(element.attributes.get("name", "")).lower(),
        excludes=frozenset(each.strip().lower() for each in excluded if each.strip()),
    )


def _choice(element: Element, channel: Channel, probability: float) -> Choice:
    written = lexeme(element.attributes.get("name", ""))
    amount = None
    match channel:
        case "head":
            written, amount = _HEADS.get(written.lower(), (written.upper(), None))
        case "gaze":
            direction = _LOOK.sub("", written).replace("_", "").upper()
            written = direction if direction in DIRECTIONS else "audience"
    return Choice(_PART.sub("", written) or "none", probability, amount)


def _implications(rule: Element) -> Iterator[Implication]:
    """What a rule demands and forbids beside each signal that it is about."""
    ids: dict[str, list[str]] = {}
    for each in rule.children:
        ids.setdefault(each.local, []).append(each.attributes.get("id", ""))
    for given in ids.get("ifpresent", ()):
        yield from (Implication(given, other, True) for other in ids.get("thenpresent", ()))
        yield from (Implication(given, other, False) for other in ids.get("thennotpresent", ()))
