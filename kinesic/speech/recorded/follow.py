"""Phonemes, word times and accents of a recording, from a synthesised rendition."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.utterance import STRESS_MARKS, Phoneme, Sound
from kinesic.speech.recorded.given_times import GivenTime
from kinesic.speech.recorded.loudness import compute_openings, estimate_pitch
from kinesic.speech.recorded.placement import SpeechFrames, analyse, place_words, stretch_phonemes
from kinesic.speech.recorded.prominence import find_prominences, find_prominent_words, move_stress
from kinesic.speech.recorded.rendition import Rendition
from kinesic.speech.recorded.spectrum import FRAME_PERIOD

RENDITION_BRIDGE = 5  # [frames] longest silence inside speech of a synthesised rendition
BURST_FRACTION = 0.7  # fraction of a stop consonant's duration at which it is released
STOP_LETTERS = frozenset("pbtdkgɡ")  # noqa: RUF001 - phonetic letters of stops


@dataclass(frozen=True, eq=False)
class FollowedSpeech:
    """Times of a recording's sounds and words."""

    phonemes: tuple[Phoneme, ...]  # phonemes at their times in the recording
    place: Callable[[float], float]  # time in the rendition -> time in the recording [s]
    is_followed: bool = True  # whether words are located by comparing sounds; False: spread over the recording
    words: tuple[tuple[float, float], ...] = ()  # start and end of each word [s]
    accents: tuple[bool, ...] = ()  # whether each word carries an accent


def follow_recording(
    rendition: Rendition, sound: Sound, given: Sequence[GivenTime], phonemes: Sequence[Phoneme] = ()
) -> FollowedSpeech | None:
    """Find times of a synthesised rendition's words and sounds in a recording.

    Args:
        rendition: speech of the recording's text.
        sound: the recording.
        given: given times of each word.
        phonemes: given sounds, which replace those of the rendition; empty: none are given.

    Returns:
        None if there is no word, or the recording is silent.
    """
    frames = analyse(sound)
    rendered_sound = rendition.utterance.sound
    if rendered_sound is None or not len(rendition.starts) or not frames.sequence.is_speech.any():
        return None
    rendered = analyse(rendered_sound, bridged=RENDITION_BRIDGE)
    placement = place_words(rendition, frames, given, sound.duration, rendered)
    sounds = release_stops(phonemes) or stretch_phonemes(rendition.utterance.phonemes, placement, frames)
    natural = (rendition.ends - rendition.starts).tolist()
    prominences = find_prominences(placement.words, frames.levels, estimate_pitch(sound), natural)
    accents = find_prominent_words(placement.words, prominences, _find_stressed(rendition))
    stressed = move_stress(sounds, placement.words, accents)
    return FollowedSpeech(
        open_by_loudness(stressed, frames), placement.place, words=placement.words, accents=tuple(accents.tolist())
    )


def open_by_loudness(phonemes: Sequence[Phoneme], frames: SpeechFrames) -> tuple[Phoneme, ...]:
    """Return sounds whose lip opening follows the level of the recording."""
    openings = compute_openings(frames.levels, frames.sequence.is_speech)
    return tuple(replace(sound, opening=_mean_in(openings, sound)) for sound in phonemes)


def release_stops(phonemes: Sequence[Phoneme]) -> tuple[Phoneme, ...]:
    """Return sounds whose plosives open the mouth at the burst."""
    return tuple(
        replace(sound, release=sound.start + BURST_FRACTION * sound.duration)
        if sound.letters[:1] in STOP_LETTERS
        else sound
        for sound in phonemes
    )


def _mean_in(openings: Floats, sound: Phoneme) -> float:
    first = int(sound.start / FRAME_PERIOD)
    part = openings[first : max(first + 1, int(sound.end / FRAME_PERIOD))]
    return round(float(part.mean()), 3) if len(part) else 1.0


def _find_stressed(rendition: Rendition) -> Flags:
    """Return the mask of a rendition's words with primary stress."""
    is_stressed = np.zeros(len(rendition.starts), dtype=bool)
    for sound in rendition.utterance.phonemes:
        if sound.symbol.startswith(STRESS_MARKS[0]):
            is_stressed[max(int(np.searchsorted(rendition.starts, sound.start + FRAME_PERIOD)) - 1, 0)] = True
    return is_stressed
