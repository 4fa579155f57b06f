"""A voice that is heard: espeak-ng, in a process of its own for each utterance.

What it says is the same in every run. When its marks and sounds fall is told by its own events, to the sample; a
mark is moved on to the onset of the word that it stands before, because a sound that begins with closed lips or
tongue is silent at first (12 to 49 ms at a normal rate).
"""

import math
import re
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from kinesic.body.utterance import Mark, Pause, Phoneme, Script, Sound, Utterance
from kinesic.speech.articulation import articulate
from kinesic.speech.durations import DurationModel
from kinesic.speech.espeak_pool import EngineReply, SpeechError, engine, espeak_fault, synthesise
from kinesic.speech.ssml import ssml
from kinesic.speech.writing import unreadable_letters

WORDS_PER_MINUTE = 175  # of espeak-ng at rate 1
SLOWEST, FASTEST = 80, 450  # words per minute
MIDDLE, HIGHEST = 50, 99  # espeak-ng's pitch: 50 more is an octave up
UTTERANCES_KEPT = 64  # utterances of one run
LETTERS_SHOWN = 40  # letters in a remark
MOST_CHARACTERS = 25_000  # characters, about half an hour: more than a block may last
ENGLISH = "en-us"
ALIASES: Mapping[str, str] = {  # tags that the files of espeak-ng spell otherwise
    "en": ENGLISH,
    "en-gb": "en",
    "iw": "he",
    "no": "nb",
    "pt-pt": "pt",
    "zh": "cmn",
    "zh-hk": "yue",
}

_CLOSING = re.compile(r"^[\s\"'\u2019\u201d\u00bb)\]]*[.,;:!?\u2026\u3002\uff0c\uff01\uff1f\u3001]")


class Espeak:
    """The voices of espeak-ng, with phonemes of the International Phonetic Alphabet."""

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        """Says a script.

        A pause of the script lasts as long as it says at every rate. Where the engine fails, the utterance is silent
        and has a remark that tells why.

        Args:
            script: what to say; of marks with the same name the first counts.
            rate: 1 is 175 words in a minute; 80 to 450 words are possible, and nearer ones are taken.
            pitch: times that of the voice, half to twice.

        Raises:
            ValueError: rate or pitch is not a number above 0.
        """
        for name, value in (("rate", rate), ("pitch", pitch)):
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} is {value}, must be a finite number above 0")
        return _said(script, rate, pitch)


@lru_cache(maxsize=4)
def voices(data: Path) -> Mapping[str, str]:
    """Lists espeak-ng's voices by language tag in small letters, from the folder of its data."""
    folder = data / "espeak-ng-data" / "lang"
    return {path.name.lower(): path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def voice_of(language: str, data: Path) -> tuple[str, str]:
    """Finds the voice of a language, and remarks where it is that of another.

    A tag that is too precise is made shorter: `de-AT` is spoken by `de`.

    Args:
        language: BCP 47 tag, in any spelling.
        data: folder that holds espeak-ng's data.
    """
    known = voices(data)
    tag = language.strip().replace("_", "-").lower()
    while tag:
        found = known.get(ALIASES.get(tag, tag))
        if found:
            return found, ""
        tag = tag.rpartition("-")[0]
    return known.get(ENGLISH, ENGLISH), f"no voice speaks {language!r}: it is read as if it were English"


@lru_cache(maxsize=UTTERANCES_KEPT)
def _said(script: Script, rate: float, pitch: float) -> Utterance:
    place = engine()
    if place is None:
        return DurationModel(f"nothing is heard: {espeak_fault()}").say(script, rate=rate)
    if len(script.text) > MOST_CHARACTERS:
        why = f"a text of {len(script.text)} characters is too long for one speech, at most {MOST_CHARACTERS} are said"
        return DurationModel(f"nothing is heard: {why}").say(
            replace(script, text=script.text[:MOST_CHARACTERS]), rate=rate
        )
    voice, remark = voice_of(script.language, place.data)
    lost = unreadable_letters(script.text, voice)
    if lost:
        why = f"the voice {voice} cannot read {_shown(lost)}"
        readable = script.text.translate(dict.fromkeys(map(ord, lost), " "))
        if not _has_word(readable):
            return DurationModel(f"nothing is heard: {why}").say(script, rate=rate)
        script, remark = replace(script, text=readable), "; ".join(filter(None, (remark, f"{why}: it is lost")))
    words = min(max(round(WORDS_PER_MINUTE * rate), SLOWEST), FASTEST)
    height = min(max(round(MIDDLE * (1 + math.log2(pitch))), 0), HIGHEST)
    try:
        reply = synthesise(ssml(script), place, voice=voice, words_per_minute=words, pitch=height)
    except SpeechError as error:
        return DurationModel(f"nothing is heard: {error}").say(script, rate=rate)
    utterance = _timed(script, reply)
    made = articulate(utterance.phonemes, rate=words / WORDS_PER_MINUTE)
    return replace(utterance, phonemes=made, remarks=tuple(filter(None, (remark, *utterance.remarks))))


def _shown(letters: str) -> str:
    more = len(letters) - LETTERS_SHOWN
    return f"{letters[:LETTERS_SHOWN]} and {more} other letters" if more > 0 else letters


def _timed(script: Script, reply: EngineReply) -> Utterance:
    """Converts a reply to seconds, without the silence that the engine adds after the last word."""
    ends = [sample for _, sample in reply.phonemes[1:]]
    sounds = [(symbol, begin, end) for (symbol, begin), end in zip(reply.phonemes, ends, strict=False) if symbol]
    spoken = sounds[-1][2] if sounds else 0
    trailing = sum(pause.duration for pause in script.pauses if not _has_word(script.text[pause.position :]))
    length = spoken + round(trailing * reply.rate)
    samples, said = np.zeros(length), np.frombuffer(reply.samples, dtype="<i2")[:spoken]
    samples[: len(said)] = said / 32768
    places, lost = _places(script, reply, [begin for _, begin, _ in sounds], spoken)
    marks: dict[str, float] = {}
    for stop, place in zip(script.stops(), places, strict=True):
        if isinstance(stop, Mark):
            marks.setdefault(stop.name, min(place, length) / reply.rate)
    remark = f"espeak-ng does not tell when {', '.join(lost)} falls: it is estimated" if lost else ""
    return Utterance(
        length / reply.rate,
        marks,
        tuple(Phoneme(symbol, begin / reply.rate, (end - begin) / reply.rate) for symbol, begin, end in sounds),
        "espeak-ng",
        Sound.of(reply.rate, samples),
        (remark,) if remark else (),
    )


def _places(script: Script, reply: EngineReply, onsets: Sequence[int], spoken: int) -> tuple[list[int], list[str]]:
    """Finds the sample of each stop of a script, never going back, and marks without an event of the engine.

    A mark moves on to the onset of the next word, unless a pause or closing punctuation is between them.
    """
    stops = script.stops()
    events = {int(number): sample for number, sample in reply.marks}
    anchors = {0: 0, len(script.text): spoken} | {stops[number].position: events[number] for number in events}
    known = sorted(anchors)
    found: list[int] = []
    lost: list[str] = []
    for number, stop in enumerate(stops):
        place = events.get(number)
        if place is None:
            place = round(float(np.interp(stop.position, known, [anchors[position] for position in known])))
            if isinstance(stop, Mark):
                lost.append(stop.name)
        if _is_before_word(script, number):
            following = bisect_left(onsets, place)
            place = onsets[following] if following < len(onsets) else place
        found.append(max([place, *found[-1:]]))
    return found, lost


def _is_before_word(script: Script, number: int) -> bool:
    position = script.stops()[number].position
    later = (stop.position for stop in script.stops()[number + 1 :] if isinstance(stop, Pause))
    if any(not _has_word(script.text[position:pause]) for pause in later):
        return False
    return not _CLOSING.match(script.text[position:])


def _has_word(text: str) -> bool:
    return any(character.isalnum() for character in text)
