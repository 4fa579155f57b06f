"""Articulation times of the sounds that espeak-ng reports.

An event marks the first sample of its sound's own part. For a voiceless stop this is the burst; the silence of the
closed lips or tongue before it counts as the previous sound. For a vowel it is the end of the mouth's opening, which
counts as the consonant. The constants below were measured on English at rates of 0.8, 1 and 1.25 and are the same
at all (docs/how-to/choose-a-voice.md).
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from kinesic.body.utterance import VOWEL_LETTERS, Phoneme

VOICELESS_STOPS = frozenset("ptkcqʈ")  # phonetic letters of voiceless stops
VOICED_STOPS = frozenset("bdgɡɖɟɓɗ")  # noqa: RUF001 - phonetic letters of voiced stops
NASAL_SOUNDS = frozenset("mnŋɲɳɱ")  # phonetic letters of nasals
GLIDE_SOUNDS = frozenset("lɹrwjʎ")  # phonetic letters of glides and liquids
CLOSURE_TIME = 0.036  # [s] duration of the closure before the burst of a voiceless stop, at rate 1
MAX_GAP = 0.02  # [s] a longer gap between two sounds counts as a pause
FINAL_BURST_FRACTION = 0.5  # fraction of a voiced stop's duration at its burst, if a pause follows
OPENING_FRACTIONS = (  # phonetic letters -> fraction of their duration at which the mouth opens for a vowel
    (VOICED_STOPS, 0.62),
    (NASAL_SOUNDS, 0.7),
    (GLIDE_SOUNDS, 0.6),
)


def articulate(phonemes: Sequence[Phoneme], *, rate: float) -> tuple[Phoneme, ...]:
    """Return sounds with the times when their mouth shapes begin and end.

    Args:
        phonemes: sounds of an utterance in order, with the times of their events.
        rate: speech rate; 1 is normal.
    """
    articulated = [
        _articulate_one(
            sound, _find_adjacent_letter(before, sound), _find_adjacent_letter(after, sound), CLOSURE_TIME / rate
        )
        for before, sound, after in _with_neighbours(phonemes)
    ]
    return tuple(_join(*neighbours) for neighbours in _with_neighbours(articulated))


def _with_neighbours(sounds: Sequence[Phoneme]) -> Iterator[tuple[Phoneme | None, Phoneme, Phoneme | None]]:
    """Yield each sound of an utterance with its neighbouring sounds."""
    return zip((None, *sounds), sounds, (*sounds[1:], None), strict=False)


def _find_adjacent_letter(other: Phoneme | None, sound: Phoneme) -> str:
    """Return the letter of a neighbouring sound that touches this sound.

    The result is empty if a pause lies between.
    """
    if other is None or max(other.start - sound.end, sound.start - other.end) > MAX_GAP:
        return ""
    return other.letters[-1:] if other.start < sound.start else other.letters[:1]


def _articulate_one(sound: Phoneme, before: str, after: str, closed: float) -> Phoneme:
    """Return one sound with articulation times that depend on its neighbours' letters."""
    first, onset = sound.letters[:1], sound.start
    has_burst = first in VOICELESS_STOPS or (first in VOICED_STOPS and not _is_open(before))  # the event is the burst
    if has_burst:
        onset -= closed
    fraction = 0.0 if has_burst else _compute_opening_fraction(first, after)
    if len(sound.letters) > 1:  # a stop that continues as a fricative
        fraction = 1.0
    return replace(sound, onset=onset, release=sound.start + fraction * sound.duration)


def _compute_opening_fraction(letter: str, after: str) -> float:
    """Return the fraction of a sound's duration before the mouth opens."""
    if letter in VOICED_STOPS and not after:
        return FINAL_BURST_FRACTION
    if not _is_open(after):
        return 1.0
    return next((fraction for letters, fraction in OPENING_FRACTIONS if letter in letters), 1.0)


def _is_open(letter: str) -> bool:
    return letter in VOWEL_LETTERS or letter in GLIDE_SOUNDS


def _join(before: Phoneme | None, sound: Phoneme, after: Phoneme | None) -> Phoneme:
    """Extend or cut a sound's articulation to meet neighbouring sounds.

    It starts when the sound before is released and ends when the next one starts.
    """
    onset, release = sound.articulation
    if before is not None and sound.start - before.end < MAX_GAP:
        onset = min(onset, max(before.articulation))
    if after is not None:
        release = max(onset, min(release, after.articulation[0]))
    return replace(sound, onset=onset, release=release)
