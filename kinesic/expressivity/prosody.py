"""Head nods, raised brows and blinks by the prosody of a speech.

Speakers mark pitch accents by nods and raised brows (H. P. Graf et al., Visual prosody: facial movements accompanying
speech, Face and Gesture 2002; C. Cave et al., About the relationship between eyebrow movements and F0 variations, ICSLP
1996), and blink at the ends of phrases (T. Nakano and S. Kitazawa, Eyeblink entrainment at breakpoints of speech,
Experimental Brain Research 2010).
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from zlib import crc32

import numpy as np

from kinesic.bml.timing.syllables import find_accented_vowels
from kinesic.body.utterance import Phoneme, Script, Utterance

NOD_SPACING = 0.7, 1.1  # [s] range of the random minimum interval after a nod on an own accent
BROW_SPACING = 1.8, 3.6  # [s] range of the random minimum interval after raised brows
EMPHASIS_SPACING = 0.7  # [s] shortest interval between an emphasised word and another accent with motion
BROW_PROBABILITY = 0.4  # probability that the brows accompany a nod
BROW_INTENSITIES = 0.26, 0.42  # range of the intensity of raised brows on an accent
EMPHASIS_FACTOR = 1.8  # factor on nod and brows of an emphasised word
EMPHASIS_LEVELS = ("moderate", "strong")  # SSML emphasis levels that get nods and raised brows
EMPHASIS_MARGIN = 0.15  # [s] tolerance of the estimated time of an emphasised word
MIN_PHRASE_PAUSE = 0.15  # [s] shortest silence that ends a phrase
OPENING_LIMITS = 0.3, 1.7  # smallest and largest lip opening / opening at the median loudness


@dataclass(frozen=True)
class Prosody:
    """Amount of motion by prosody, with its random seed."""

    amount: float = 0.0  # 0 none .. 1 like a person's .. 2 twice as much
    seed: int = 0  # seed of the random generator; the same seed gives the same motion


NO_PROSODY = Prosody()  # no motion by prosody


@dataclass(frozen=True)
class Accent:
    """Motion of head and brows on an accented syllable."""

    time: float  # [s] time from the start of the utterance
    nod: float = 0.0  # amplitude / amplitude of a usual nod; 0: none
    brow: float = 0.0  # intensity of the raised brows, 0..1; 0: none


def choose_accents(speech: str, utterance: Utterance, script: Script, seed: int) -> tuple[Accent, ...]:
    """Choose the accents of a speech with nods or raised brows.

    Nods are more frequent than raised brows. Emphasised words have both.

    Args:
        speech: id of the speech.
        utterance: its timing.
        script: its text, with emphases.
        seed: of the random generator.
    """
    chance = np.random.default_rng((seed, crc32(speech.encode())))
    accents = utterance.accents or find_accented_vowels(utterance.phonemes)
    spans = tuple(_emphasised_spans(utterance, script))
    emphasised = {time for begin, end in spans for time in [t for t in accents if begin <= t <= end][:1]}
    next_nod = next_brow = -np.inf
    chosen: list[Accent] = []
    for time in accents:
        accompanies, intensity = chance.uniform() < BROW_PROBABILITY, float(chance.uniform(*BROW_INTENSITIES))
        spacing = float(chance.uniform(*NOD_SPACING)), float(chance.uniform(*BROW_SPACING))
        if time in emphasised:
            chosen.append(Accent(time, EMPHASIS_FACTOR, min(EMPHASIS_FACTOR * intensity, 1.0)))
        elif any(abs(time - other) < EMPHASIS_SPACING for other in emphasised):
            continue
        elif time >= next_nod:
            has_brow = accompanies and time >= next_brow
            chosen.append(Accent(time, 1.0, intensity if has_brow else 0.0))
        elif time >= next_brow:
            chosen.append(Accent(time, 0.0, intensity))
        else:
            continue
        next_nod = time + spacing[0] if chosen[-1].nod else next_nod
        next_brow = time + spacing[1] if chosen[-1].brow else next_brow
    return tuple(chosen)


def find_phrase_ends(utterance: Utterance) -> tuple[float, ...]:
    """Return the times [s] at which the phrases of an utterance end.

    A phrase ends before a silence, and with the utterance.
    """
    sounds = utterance.phonemes
    ends = [before.end for before, after in pairwise(sounds) if after.start - before.end >= MIN_PHRASE_PAUSE]
    return (*ends, *(sound.end for sound in sounds[-1:]))


def scale_openings(phonemes: tuple[Phoneme, ...], amount: float) -> tuple[Phoneme, ...]:
    """Scale the effect of loudness on the lip opening by an amount."""
    return tuple(
        replace(sound, opening=float(np.clip(1.0 + amount * (sound.opening - 1.0), *OPENING_LIMITS)))
        for sound in phonemes
    )


def _emphasised_spans(utterance: Utterance, script: Script) -> Iterator[tuple[float, float]]:
    """Yield the estimated time spans [s] of emphasised words.

    Times between marks are interpolated by the number of characters.
    """
    if not utterance.phonemes:
        return
    known_times = {0: utterance.phonemes[0].start, len(script.text): utterance.phonemes[-1].end}
    known_times |= {mark.position: utterance.marks[mark.name] for mark in script.marks if mark.name in utterance.marks}
    positions = sorted(known_times)
    times = [known_times[position] for position in positions]
    for emphasis in script.emphases:
        level = dict(emphasis.attributes).get("level", EMPHASIS_LEVELS[0])
        if emphasis.element == "emphasis" and level in EMPHASIS_LEVELS:
            begin, end = np.interp((emphasis.begin, emphasis.end), positions, times)
            yield float(begin) - EMPHASIS_MARGIN, float(end) + EMPHASIS_MARGIN
