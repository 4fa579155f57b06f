"""Audible voice: espeak-ng, with a new process for each utterance.

An utterance is the same in every run. Marks and sounds get their times from the engine's events, exact to the sample. A
mark moves on to the onset of the word after it, because a sound with closed lips or tongue starts silent (12 to 49 ms
at a normal rate).
"""

import math
import re
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from kinesic.body.scripts import PHRASE_STOPS, SENTENCE_STOPS
from kinesic.body.utterance import Mark, Pause, Phoneme, Script, Sound, Utterance
from kinesic.speech.articulation import articulate
from kinesic.speech.durations import DurationModel
from kinesic.speech.espeak_pool import EngineReply, SpeechError, espeak_fault, find_engine, synthesise
from kinesic.speech.ssml import write_ssml
from kinesic.speech.voice_level import open_vowels_by_level
from kinesic.speech.writing import unreadable_letters

WORDS_PER_MINUTE = 175  # [words/min] rate of espeak-ng at rate factor 1
MIN_WORD_RATE = 80  # [words/min] slowest rate of espeak-ng
MAX_WORD_RATE = 450  # [words/min] fastest rate of espeak-ng
NORMAL_PITCH = 50  # default pitch on espeak-ng's scale; 50 more is an octave higher
MAX_PITCH = 99  # largest pitch on espeak-ng's scale
CACHED_UTTERANCES = 64  # number of cached utterances
MAX_LISTED_LETTERS = 40  # largest number of unreadable letters listed in a remark
MAX_CHARACTERS = 25_000  # [characters] longest script, about half an hour: longer than a block may last
ENGLISH_TAG = "en-us"  # language in which espeak-ng reads texts of unsupported languages
LANGUAGE_ALIASES: Mapping[str, str] = {  # BCP 47 tag -> tag in espeak-ng's files
    "en": ENGLISH_TAG,
    "en-gb": "en",
    "iw": "he",
    "no": "nb",
    "pt-pt": "pt",
    "zh": "cmn",
    "zh-hk": "yue",
}

# punctuation before which a mark stays at the previous word
_CLOSING_PATTERN = re.compile(rf"^[\s\"'\u2019\u201d\u00bb)\]]*[{SENTENCE_STOPS}{PHRASE_STOPS}]")


class Espeak:
    """Voice that synthesises speech and its IPA phonemes with espeak-ng."""

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        """Synthesise a script with espeak-ng.

        A pause of the script has the same duration at every rate. If the engine fails, the utterance is silent and has
        a remark with the reason.

        Args:
            script: text to say; of marks with the same name the first counts.
            rate: 1 is 175 words per minute; the range is 80 to 450 words per minute, other values are clipped.
            pitch: factor of the voice's pitch, 0.5 to 2.

        Raises:
            ValueError: rate or pitch is not a finite number above 0.
        """
        for name, value in (("rate", rate), ("pitch", pitch)):
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} is {value}, must be a finite number above 0")
        return _say(script, rate, pitch)


@lru_cache(maxsize=4)
def list_voices(data: Path) -> Mapping[str, str]:
    """Return the names of espeak-ng's voices by lower-case language tag.

    A name is the path of the voice's file, such as `gmw/en-US`.
    """
    folder = data / "espeak-ng-data" / "lang"
    return {path.name.lower(): path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def find_voice(language: str, data: Path) -> tuple[str, str]:
    """Return espeak-ng's voice for a language, and a remark if unsupported.

    A language without a voice is read as English. The remark is empty otherwise.
    A tag that is too specific is shortened: `de-AT` is spoken by `de`.

    Args:
        language: BCP 47 tag in any spelling.
        data: folder with espeak-ng's data.
    """
    by_tag = list_voices(data)
    tag = language.strip().replace("_", "-").lower()
    while tag:
        voice = by_tag.get(LANGUAGE_ALIASES.get(tag, tag))
        if voice:
            return voice, ""
        tag = tag.rpartition("-")[0]
    return by_tag.get(ENGLISH_TAG, ENGLISH_TAG), f"no voice speaks {language!r}: it is read as English"


@lru_cache(maxsize=CACHED_UTTERANCES)
def _say(script: Script, rate: float, pitch: float) -> Utterance:
    paths = find_engine()
    if paths is None:
        return DurationModel(f"no sound: {espeak_fault()}").say(script, rate=rate)
    if len(script.text) > MAX_CHARACTERS:
        why = f"a text of {len(script.text)} characters is too long for one speech; the maximum is {MAX_CHARACTERS}"
        return DurationModel(f"no sound: {why}").say(replace(script, text=script.text[:MAX_CHARACTERS]), rate=rate)
    voice, remark = find_voice(script.language, paths.data)
    missing = unreadable_letters(script.text, voice)
    if missing:
        why = f"the voice {voice} cannot read {_list_letters(missing)}"
        readable = script.text.translate(dict.fromkeys(map(ord, missing), " "))
        if not _has_word(readable):
            return DurationModel(f"no sound: {why}").say(script, rate=rate)
        script = replace(script, text=readable)
        remark = "; ".join(filter(None, (remark, f"{why}: it is omitted")))
    words = min(max(round(WORDS_PER_MINUTE * rate), MIN_WORD_RATE), MAX_WORD_RATE)
    pitch_value = min(max(round(NORMAL_PITCH * (1 + math.log2(pitch))), 0), MAX_PITCH)
    try:
        reply = synthesise(write_ssml(script), paths, voice=voice, words_per_minute=words, pitch=pitch_value)
    except SpeechError as error:
        return DurationModel(f"no sound: {error}").say(script, rate=rate)
    utterance = _convert_reply(script, reply)
    articulated = articulate(utterance.phonemes, rate=words / WORDS_PER_MINUTE)
    if utterance.sound is not None:
        articulated = open_vowels_by_level(articulated, utterance.sound)
    return replace(utterance, phonemes=articulated, remarks=tuple(filter(None, (remark, *utterance.remarks))))


def _list_letters(letters: str) -> str:
    more = len(letters) - MAX_LISTED_LETTERS
    return f"{letters[:MAX_LISTED_LETTERS]} and {more} other letters" if more > 0 else letters


def _convert_reply(script: Script, reply: EngineReply) -> Utterance:
    """Convert an engine reply to an utterance, without the engine's final silence."""
    ends = [sample for _, sample in reply.phonemes[1:]]
    sounds = [(symbol, begin, end) for (symbol, begin), end in zip(reply.phonemes, ends, strict=False) if symbol]
    spoken = sounds[-1][2] if sounds else 0
    trailing = sum(pause.duration for pause in script.pauses if not _has_word(script.text[pause.position :]))
    length = spoken + round(trailing * reply.rate)
    samples, spoken_samples = np.zeros(length), np.frombuffer(reply.samples, dtype="<i2")[:spoken]
    samples[: len(spoken_samples)] = spoken_samples / 32768
    samples_of_stops, missing = _find_samples(script, reply, [begin for _, begin, _ in sounds], spoken)
    marks: dict[str, float] = {}
    for stop, sample in zip(script.stops(), samples_of_stops, strict=True):
        if isinstance(stop, Mark):
            marks.setdefault(stop.name, min(sample, length) / reply.rate)
    remark = f"espeak-ng does not report the time of {', '.join(missing)}: it is estimated" if missing else ""
    return Utterance(
        length / reply.rate,
        marks,
        tuple(Phoneme(symbol, begin / reply.rate, (end - begin) / reply.rate) for symbol, begin, end in sounds),
        "espeak-ng",
        Sound.of(reply.rate, samples),
        (remark,) if remark else (),
    )


def _find_samples(
    script: Script, reply: EngineReply, onsets: Sequence[int], spoken: int
) -> tuple[list[int], list[str]]:
    """Return sample indices of marks and pauses, and names of unreported marks.

    A mark moves on to the onset of the next word, unless a pause or closing punctuation lies between.
    """
    stops = script.stops()
    events = {int(number): sample for number, sample in reply.marks}
    anchors = {0: 0, len(script.text): spoken} | {stops[number].position: events[number] for number in events}
    positions = sorted(anchors)
    result: list[int] = []
    missing: list[str] = []
    for number, stop in enumerate(stops):
        sample = events.get(number)
        if sample is None:
            sample = round(float(np.interp(stop.position, positions, [anchors[position] for position in positions])))
            if isinstance(stop, Mark):
                missing.append(stop.name)
        if _is_before_word(script, number):
            following = bisect_left(onsets, sample)
            sample = onsets[following] if following < len(onsets) else sample
        result.append(max([sample, *result[-1:]]))
    return result, missing


def _is_before_word(script: Script, number: int) -> bool:
    position = script.stops()[number].position
    later = (stop.position for stop in script.stops()[number + 1 :] if isinstance(stop, Pause))
    if any(not _has_word(script.text[position:pause]) for pause in later):
        return False
    return not _CLOSING_PATTERN.match(script.text[position:])


def _has_word(text: str) -> bool:
    return any(character.isalnum() for character in text)
