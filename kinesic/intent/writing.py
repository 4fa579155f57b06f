"""Writes BML: what is said with sync points on its words, and behaviours, each with the reason for it."""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import count

from kinesic.intent.behaviour_sets import DIRECTIONS, Channel
from kinesic.intent.choosing import ChosenBehaviour
from kinesic.intent.intents import shift_reference
from kinesic.intent.markup import escape, quote
from kinesic.intent.reading.passage import SPEECH, Passage, mark

NAMESPACES = 'xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic"'
LETTERS: Mapping[Channel, str] = {
    "gesture": "g",
    "head": "h",
    "face": "f",
    "gaze": "l",
    "torso": "t",
}  # that ids begin with
ASIDE = 20.0  # [deg] that eyes look aside with amount 1
LEAST_FACE, LEAST_LOOK, LEAST_TILT = 0.8, 0.7, 0.8  # [s]
SOON = 0.1  # [s] that a face sets out before its word
LINE = 100  # letters of a line of speech, about
_USED = re.compile(rf'{SPEECH}:(\w+)["+-]')  # a sync point of the speech that a behaviour is tied to


def write_block(
    passage: Passage,
    behaviours: Sequence[ChosenBehaviour],
    *,
    block: str = "said",
    words: range | None = None,
    start: str = "",
) -> str:
    """Writes a block that says a text and performs what was chosen for it.

    Args:
        passage: the text.
        behaviours: that were chosen.
        block: its id.
        words: which words of the text it says; None: all.
        start: sync point at which it begins to speak; without one where the behaviours let it.
    """
    elements = list(write_behaviours(behaviours))
    used = "\n".join(elements)
    beginning = f" start={quote(start)}" if start else ""
    lines = [
        f'<bml {NAMESPACES} id="{block}">',
        f'  <speech id="{SPEECH}" language={quote(passage.language)}{beginning}>',
        f"    <text>{_spoken(passage, used, words or range(len(passage.words)))}</text>",
        "  </speech>",
        *(f"  {element}" for element in elements),
        "</bml>",
    ]
    return "\n".join(lines) + "\n"


def write_behaviours(behaviours: Iterable[ChosenBehaviour], taken: Collection[str] = ()) -> Iterator[str]:
    """Writes each behaviour as an element of BML, with an id that is not taken."""
    for id, each in name_behaviours(behaviours, taken):
        yield _element(each, id)


def name_behaviours(
    behaviours: Iterable[ChosenBehaviour], taken: Collection[str] = ()
) -> Iterator[tuple[str, ChosenBehaviour]]:
    """Gives each behaviour the id under which it is written, which is not taken."""
    ids = {channel: _free_ids(letter, taken) for channel, letter in LETTERS.items()}
    for each in behaviours:
        yield next(ids[each.channel]), each


def _free_ids(letter: str, taken: Collection[str]) -> Iterator[str]:
    return (id for number in count(1) if (id := f"{letter}{number}") not in taken)


def _element(each: ChosenBehaviour, id: str) -> str:
    intent = each.intent
    written = {"id": id}
    match each.channel:
        case "gesture" if intent.target:
            name = "pointing"
            written |= {"target": intent.target, "stroke": shift_reference(intent.stroke, 0.0)}
        case "gesture":
            name = "gesture"
            written |= {"lexeme": each.lexeme, "stroke": shift_reference(intent.stroke, 0.0)}
        case "head" if each.lexeme in ("NOD", "SHAKE"):
            name = "head"
            written |= {"lexeme": each.lexeme, **_numbers(each), "stroke": shift_reference(intent.stroke, 0.0)}
        case "head":
            name = "head"
            written |= {"lexeme": each.lexeme, **_numbers(each), **_span(each, LEAST_TILT)}
        case "face":
            name = "faceLexeme"
            written |= {"lexeme": each.lexeme, **_numbers(each), **_span(each, LEAST_FACE)}
        case "gaze":
            name = "gaze"
            written |= {**_look(each), **_span(each, LEAST_LOOK)}
        case "torso":
            name = "torso"
            written |= {"lexeme": each.lexeme, **_numbers(each), **_span(each, LEAST_FACE)}
    if each.begin:
        written["start"] = each.begin
    written |= {f"kinesic:{name}": f"{value:.3g}" for name, value in each.manner.items()}
    if intent.style and each.channel == "gesture":
        written["kinesic:style"] = intent.style
    written["kinesic:reason"] = f"{intent.reason} ({intent.name}, {intent.certainty:.2f})"
    return f"<{name} {' '.join(f'{key}={quote(value)}' for key, value in written.items())}/>"


def _numbers(each: ChosenBehaviour) -> dict[str, str]:
    amount = each.amount if each.amount is None else each.amount * each.intent.strength
    numbers = {"amount": amount, "repetition": each.repetition}
    return {name: f"{number:g}" for name, number in numbers.items() if number is not None}


def _span(each: ChosenBehaviour, least: float) -> dict[str, str]:
    """From the start of an intent to its end, but at least so many seconds [s]."""
    start, end = each.intent.start, each.intent.end
    seconds = max(end.seconds - start.seconds, least)
    if seconds == end.seconds - start.seconds:
        return {"start": shift_reference(start, -SOON), "end": shift_reference(end, 0.0)}
    return {"start": shift_reference(start, -SOON), "end": shift_reference(start, seconds - SOON)}


def _look(each: ChosenBehaviour) -> dict[str, str]:
    direction = each.lexeme.upper()
    if direction not in DIRECTIONS:
        return {"target": each.lexeme}
    angle = ASIDE * (0.5 if each.amount is None else each.amount)
    return {"influence": "EYES", "offsetAngle": f"{angle:g}", "offsetDirection": direction}


def _spoken(passage: Passage, used: str, words: range) -> str:
    """What is said, with a sync point before each word that a behaviour is tied to."""
    pieces: list[str] = []
    length, marks = 0, frozenset(_USED.findall(used))
    for k in words:
        word = passage.words[k]
        is_first = k == words.start > 0  # what ends the words before it is said with them
        between = escape(word.before.partition(" ")[2] if is_first else word.before)
        if length > LINE and between.endswith(" "):
            between, length = f"{between.rstrip()}\n      ", 0
        pause = f'<break time="{word.pause:g}s"/>' if word.pause and not is_first else ""
        sync = f'<sync id="{mark(k)}"/>' if mark(k) in marks else ""
        said = f'<emphasis level="strong">{escape(word.text)}</emphasis>' if word.emphatic else escape(word.text)
        pieces.append(f"{between}{pause}{sync}{said}")
        length += len(word.before) + len(sync) + len(said)
    if words.stop < len(passage.words):
        return f"{''.join(pieces)}{escape(passage.words[words.stop].before.partition(' ')[0])}"
    pause = f'<break time="{passage.tail_pause:g}s"/>' if passage.tail_pause else ""
    return f"{''.join(pieces)}{escape(passage.tail)}{pause}"
