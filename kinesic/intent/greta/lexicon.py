"""Reader of Greta's lexicons of intentions.

They contain behaviour sets with core, alternatives, implications and sequences.
"""

import re
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from kinesic.bml.reading.manner import strip_category
from kinesic.bml.reading.tree import Element
from kinesic.body.config import ConfigError
from kinesic.intent.behaviour_sets import (
    GAZE_DIRECTIONS,
    BehaviourSet,
    BehaviourSets,
    Channel,
    Choice,
    Implication,
    Signal,
    Spell,
    builtin_sets,
)
from kinesic.intent.greta.files import number_of, read_root

CHANNEL_BY_MODALITY: dict[str, Channel] = {
    "gesture": "gesture",
    "pointing": "gesture",
    "head": "head",
    "face": "face",
    "gaze": "gaze",
    "torso": "torso",
    "shoulder": "torso",
}
SEQUENCE_TYPE = "mse"  # type of a set of successive signals
POINTING_GESTURE = "this_index"  # gesture for all signals with the modality `pointing`
DEFAULT_DURATIONS = (1.0, 3.0)  # [s] shortest and longest signal in a sequence, if the file gives none

_STAGE_SUFFIX = re.compile(r"_signal_\d+$", re.IGNORECASE)  # end of the names of expressions with several stages
_GAZE_PREFIX = re.compile(r"^look_", re.IGNORECASE)  # beginning of the names of gazes
_HEAD_LEXEMES = {  # head movement in Greta -> BML lexeme, amount
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
    """Read a Greta lexicon with the built-in behaviour sets as a fallback.

    Raises:
        ConfigError: the file is missing, or is not a lexicon of intentions.
    """
    root = read_root(path, "behaviorsets")
    sets = [_behaviour_set(child, path) for child in root.children if child.local == "behaviorset"]
    return BehaviourSets({behaviour_set.name: behaviour_set for behaviour_set in sets}, fallback=builtin_sets())


def _behaviour_set(element: Element, path: Path) -> BehaviourSet:
    name = element.attributes.get("name", "").strip()
    if not name:
        raise ConfigError(f"{path}:{element.place.line}: a behaviorset without a name")
    inside = {child.local: child for child in element.children}
    is_sequence = element.attributes.get("type", "").strip().lower() == SEQUENCE_TYPE
    signals = inside["signals"].children if "signals" in inside else ()
    constraints = inside["constraints"].children if "constraints" in inside else ()
    core = [item for constraint in constraints if constraint.local == "core" for item in constraint.children]
    rules = [rule for constraint in constraints if constraint.local == "rules" for rule in constraint.children]
    return BehaviourSet(
        name,
        tuple(signal for item in signals for signal in [_signal(item, path, is_sequence)] if signal),
        frozenset(item.attributes.get("id", "") for item in core),
        tuple(implication for rule in rules for implication in _read_implications(rule)),
    )


def _signal(element: Element, path: Path, is_sequence: bool) -> Signal | None:
    """Convert an XML element of a Greta lexicon to a signal.

    Returns:
        None for a body part that kinesic does not move.
    """
    modality = element.attributes.get("modality", "").strip().lower()
    if modality not in CHANNEL_BY_MODALITY:
        return None
    channel = CHANNEL_BY_MODALITY[modality]
    others = [
        (alternative, number_of(alternative, "probability", path, 0.0))
        for alternative in element.children
        if alternative.local == "alternative"
    ]
    rest = max(0.0, 1.0 - sum(share for _, share in others))
    choices = [
        _choice(element, channel, rest),
        *(_choice(alternative, channel, share) for alternative, share in others),
    ]
    if modality == "pointing":
        choices = [Choice(POINTING_GESTURE, 1.0)]
    return Signal(
        element.attributes.get("id", ""),
        channel,
        tuple(choices),
        _spell(element, path) if is_sequence else None,
    )


def _spell(element: Element, path: Path) -> Spell:
    excluded = element.attributes.get("excludelist", "").split(",")
    return Spell(
        number_of(element, "min", path, DEFAULT_DURATIONS[0]),
        number_of(element, "max", path, DEFAULT_DURATIONS[1]),
        number_of(element, "probability_start", path, 0.5),
        number_of(element, "probability_end", path, 0.5),
        repeats=number_of(element, "repetitivity", path, 0.0) > 0.0,
        name=strip_category(element.attributes.get("name", "")).lower(),
        excludes=frozenset(name.strip().lower() for name in excluded if name.strip()),
    )


def _choice(element: Element, channel: Channel, probability: float) -> Choice:
    written = strip_category(element.attributes.get("name", ""))
    amount = None
    match channel:
        case "head":
            written, amount = _HEAD_LEXEMES.get(written.lower(), (written.upper(), None))
        case "gaze":
            direction = _GAZE_PREFIX.sub("", written).replace("_", "").upper()
            written = direction if direction in GAZE_DIRECTIONS else "audience"
    return Choice(_STAGE_SUFFIX.sub("", written) or "none", probability, amount)


def _read_implications(rule: Element) -> Iterator[Implication]:
    """Yield the required and forbidden signals of a Greta rule."""
    ids: dict[str, list[str]] = {}
    for child in rule.children:
        ids.setdefault(child.local, []).append(child.attributes.get("id", ""))
    for given in ids.get("ifpresent", ()):
        yield from (Implication(given, other, True) for other in ids.get("thenpresent", ()))
        yield from (Implication(given, other, False) for other in ids.get("thennotpresent", ()))
