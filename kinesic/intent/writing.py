"""Serialisation of speech and behaviours to BML, with a reason for each."""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import count

from kinesic.intent.behaviour_sets import GAZE_DIRECTIONS, Channel
from kinesic.intent.behaviours import ChosenBehaviour
from kinesic.intent.intents import shift_reference
from kinesic.intent.markup import escape, quote
from kinesic.intent.reading.passage import SPEECH_ID, Passage, mark
from kinesic.intent.reading.prosody import Prosody, merge_prosody, write_tag
from kinesic.intent.recorded import RecordedAudio
from kinesic.intent.speeches import divide_speech, gap_before

XML_NAMESPACES = 'xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic"'
ID_LETTERS: Mapping[Channel, str] = {
    "gesture": "g",
    "head": "h",
    "face": "f",
    "gaze": "l",
    "torso": "t",
}  # first letters of behaviour ids
GAZE_OFFSET_ANGLE = 20.0  # [deg] offset of an averted gaze with amount 1
MIN_FACE_TIME = 0.8  # [s] shortest facial expression or torso movement
MIN_GAZE_TIME = 0.7  # [s] shortest duration of a gaze
MIN_TILT_TIME = 0.8  # [s] shortest head movement other than a nod or shake
START_LEAD_TIME = 0.1  # [s] start of a face, gaze, torso or tilt behaviour before its word
LINE_LENGTH = 100  # [letters] approximate length of a line of spoken text in the BML
_WORD_REFERENCE = re.compile(rf'="{SPEECH_ID}:w(\d+)')  # reference to the mark of a word
_USED_SYNCS = re.compile(rf'{SPEECH_ID}:(\w+)["+-]')  # sync points of the speech that behaviours use


def write_block(
    passage: Passage,
    behaviours: Sequence[ChosenBehaviour],
    *,
    block: str = "said",
    words: range | None = None,
    start: str = "",
    recorded: RecordedAudio | None = None,
) -> str:
    """Write a block that speaks a text and performs the chosen behaviours.

    A long text has several speeches, one after the other. A recording is one speech.

    Args:
        passage: the text.
        behaviours: chosen ones.
        block: its id.
        words: spoken words of the text; None: all.
        start: sync point at which it begins to speak; empty: as the behaviours allow.
        recorded: recording that is played; None: a voice speaks.
    """
    elements = list(write_behaviours(behaviours))
    used = frozenset(_USED_SYNCS.findall("\n".join(elements)))
    if recorded is not None:
        words = range(len(passage.words))
    speeches = divide_speech(passage) if words is None else [words]
    spoken = list[str]()
    for number, part in enumerate(speeches):
        begin = f"{_speech_id(number - 1)}:end+{gap_before(passage, part.start):.2f}" if number else start
        beginning = f" start={quote(begin)}" if begin else ""
        spoken += [
            f'  <speech id="{_speech_id(number)}" language={quote(passage.voice or passage.language)}{beginning}>',
            f"    <text>{_write_spoken_text(passage, used, part)}</text>",
            *([f"    {recorded.write()}"] if recorded is not None else []),
            "  </speech>",
        ]
    if len(speeches) > 1:
        ids = [_speech_id(number) for number, part in enumerate(speeches) for _ in part]
        elements = [_WORD_REFERENCE.sub(lambda found: _refer(found[1], ids), element) for element in elements]
    lines = [
        f'<bml {XML_NAMESPACES} id="{block}">',
        *(spoken if speeches[0] or not elements or recorded is not None else []),
        *(f"  {element}" for element in elements),
        "</bml>",
    ]
    return "\n".join(lines) + "\n"


def _refer(word: str, ids: Sequence[str]) -> str:
    """Return `="SPEECH:wWORD`, a sync reference without closing quote."""
    return f'="{ids[int(word) - 1]}:w{word}'


def _speech_id(number: int) -> str:
    return f"{SPEECH_ID}{number + 1}" if number else SPEECH_ID


def write_behaviours(behaviours: Iterable[ChosenBehaviour], taken: Collection[str] = ()) -> Iterator[str]:
    """Write each behaviour as a BML element with an unused id."""
    for id, behaviour in name_behaviours(behaviours, taken):
        yield _element(behaviour, id)


def name_behaviours(
    behaviours: Iterable[ChosenBehaviour], taken: Collection[str] = ()
) -> Iterator[tuple[str, ChosenBehaviour]]:
    """Yield each behaviour with an unused id for its BML element."""
    ids = {channel: _free_ids(letter, taken) for channel, letter in ID_LETTERS.items()}
    for behaviour in behaviours:
        yield next(ids[behaviour.channel]), behaviour


def _free_ids(letter: str, taken: Collection[str]) -> Iterator[str]:
    return (id for number in count(1) if (id := f"{letter}{number}") not in taken)


def _element(behaviour: ChosenBehaviour, id: str) -> str:
    intent = behaviour.intent
    attributes = {"id": id}
    match behaviour.channel:
        case "gesture" if intent.target and not behaviour.captured:
            name = "pointing"
            attributes |= {"target": intent.target, "stroke": shift_reference(intent.stroke, 0.0)}
        case "gesture":
            name = "gesture"
            hand = {"mode": f"{intent.hand.upper()}_HAND"} if intent.hand else {}
            target = {"target": intent.target} if intent.target else {}
            stroke = {"stroke": shift_reference(intent.stroke, 0.0)}
            attributes |= {"lexeme": behaviour.lexeme, **target, **hand, **stroke}
        case "head" if behaviour.lexeme in ("NOD", "SHAKE"):
            name = "head"
            attributes |= {
                "lexeme": behaviour.lexeme,
                **_numbers(behaviour),
                "stroke": shift_reference(intent.stroke, 0.0),
            }
        case "head":
            name = "head"
            attributes |= {"lexeme": behaviour.lexeme, **_numbers(behaviour), **_write_span(behaviour, MIN_TILT_TIME)}
        case "face":
            name = "faceLexeme"
            attributes |= {"lexeme": behaviour.lexeme, **_numbers(behaviour), **_write_span(behaviour, MIN_FACE_TIME)}
        case "gaze":
            name = "gaze"
            attributes |= {**_look(behaviour), **_write_span(behaviour, MIN_GAZE_TIME)}
        case "torso":
            name = "torso"
            attributes |= {"lexeme": behaviour.lexeme, **_numbers(behaviour), **_write_span(behaviour, MIN_FACE_TIME)}
    if behaviour.begin:
        attributes["start"] = behaviour.begin
    attributes |= {f"kinesic:{name}": f"{value:.3g}" for name, value in behaviour.manner.items()}
    if intent.style and behaviour.channel == "gesture":
        attributes["kinesic:style"] = intent.style
    attributes["kinesic:reason"] = f"{intent.reason} ({intent.name}, {intent.certainty:.2f})"
    return f"<{name} {' '.join(f'{key}={quote(value)}' for key, value in attributes.items())}/>"


def _numbers(behaviour: ChosenBehaviour) -> dict[str, str]:
    amount = behaviour.amount if behaviour.amount is None else behaviour.amount * behaviour.intent.strength
    numbers = {"amount": amount, "repetition": behaviour.repetition}
    return {name: f"{number:g}" for name, number in numbers.items() if number is not None}


def _write_span(behaviour: ChosenBehaviour, least: float) -> dict[str, str]:
    """Return start and end attributes at least `least` seconds apart."""
    start, end = behaviour.intent.start, behaviour.intent.end
    seconds = max(end.seconds - start.seconds, least)
    if seconds == end.seconds - start.seconds:
        return {"start": shift_reference(start, -START_LEAD_TIME), "end": shift_reference(end, 0.0)}
    return {"start": shift_reference(start, -START_LEAD_TIME), "end": shift_reference(start, seconds - START_LEAD_TIME)}


def _look(behaviour: ChosenBehaviour) -> dict[str, str]:
    direction = behaviour.lexeme.upper()
    if direction not in GAZE_DIRECTIONS:
        return {"target": behaviour.lexeme}
    angle = GAZE_OFFSET_ANGLE * (0.5 if behaviour.amount is None else behaviour.amount)
    return {"influence": "EYES", "offsetAngle": f"{angle:g}", "offsetDirection": direction}


def _write_spoken_text(passage: Passage, used: Collection[str], words: range) -> str:
    """Return the speech text with the sync points that behaviours use."""
    pieces: list[str] = []
    length = 0
    prosody: Prosody = ()
    for k in words:
        word = passage.words[k]
        is_first = k == words.start > 0  # punctuation after the preceding word is spoken with it
        between = escape(word.before.partition(" ")[2] if is_first else word.before if k else word.before.lstrip())
        if length > LINE_LENGTH and between.endswith(" "):
            between, length = f"{between.rstrip()}\n      ", 0
        pause = f'<break time="{word.pause:g}s"/>' if word.pause and not is_first else ""
        sync = f'<sync id="{mark(k)}"/>' if mark(k) in used else ""
        spoken = f'<emphasis level="strong">{escape(word.text)}</emphasis>' if word.emphatic else escape(word.text)
        if merge_prosody(word.prosody) != prosody:
            closing, prosody = "</prosody>" * bool(prosody), merge_prosody(word.prosody)
            opening = write_tag("prosody", dict(prosody)) if prosody else ""
            space = between[len(between.rstrip()) :]
            between = f"{between.rstrip()}{closing}{space}{opening}"
        pieces.append(f"{between}{pause}{sync}{spoken}")
        length += len(word.before) + len(sync) + len(spoken)
    closing = "</prosody>" * bool(prosody)
    if words.stop < len(passage.words):
        return f"{''.join(pieces)}{escape(passage.words[words.stop].before.partition(' ')[0])}{closing}"
    pause = f'<break time="{passage.tail_pause:g}s"/>' if passage.tail_pause else ""
    return f"{''.join(pieces)}{escape(passage.tail)}{closing}{pause}"
