"""When the mouth makes each sound that espeak-ng says, which is not when its event comes.

An event comes with the first sample of its own part of the sound. That of a voiceless stop is its burst, and the
silence in which lips or tongue are closed counts as the sound before; that of a vowel comes when the mouth has opened,
and the opening counts as the consonant. Shares and times below were measured on the sound of English at rates of 0.8,
1 and 1.25 (docs/voice.md); they are alike at all of them.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from kinesic.body.utterance import VOWELS, Phoneme

VOICELESS, VOICED = frozenset("ptkcqʈ"), frozenset("bdgɡɖɟɓɗ")  # noqa: RUF001 - stops
NASALS = frozenset("mnŋɲɳɱ")
GLIDES = frozenset("lɹrwjʎ")
CLOSED = 0.036  # [s] at rate 1 that a voiceless stop is closed before its burst
NO_PAUSE = 0.02  # [s] between two sounds without a pause
LAST_SHARE = 0.5  # of a voiced stop before a pause, at which it bursts
SHARES = ((VOICED, 0.62), (NASALS, 0.7), (GLIDES, 0.6))  # of each, at which the mouth opens to a vowel


def articulate(phonemes: Sequence[Phoneme], *, rate: float) -> tuple[Phoneme, ...]:
    """Adds to sounds of espeak-ng when the mouth has come to them, and when it lets them go.

    Args:
        phonemes: of an utterance, in their order, as its events have them.
        rate: at which they are said; 1 is normal.
    """
    made = [
        _made(each, _letter(before, each), _letter(after, each), CLOSED / rate)
        for before, each, after in _between(phonemes)
    ]
    return tuple(_joined(*neighbours) for neighbours in _between(made))


def _between(sounds: Sequence[Phoneme]) -> Iterator[tuple[Phoneme | None, Phoneme, Phoneme | None]]:
    """Yields each sound between its neighbours."""
    return zip((None, *sounds), sounds, (*sounds[1:], None), strict=False)


def _letter(other: Phoneme | None, sound: Phoneme) -> str:
    """The nearer letter of a neighbour; none where a pause is between them."""
    if other is None or max(other.start - sound.end, sound.start - other.end) > NO_PAUSE:
        return ""
    return other.letters[-1:] if other.start < sound.start else other.letters[:1]


def _made(sound: Phoneme, before: str, after: str, closed: float) -> Phoneme:
    """Times one sound between two letters."""
    first, onset = sound.letters[:1], sound.start
    bursts = first in VOICELESS or (first in VOICED and not _is_open(before))  # at its event
    if bursts:
        onset -= closed
    share = 0.0 if bursts else _share(first, after)
    if len(sound.letters) > 1:  # what begins as a stop goes on as a fricative
        share = 1.0
    return replace(sound, onset=onset, release=sound.start + share * sound.duration)


def _share(letter: str, after: str) -> float:
    """Share of a sound after which the mouth opens to the next one."""
    if letter in VOICED and not after:
        return LAST_SHARE
    if not _is_open(after):
        return 1.0
    return next((share for letters, share in SHARES if letter in letters), 1.0)


def _is_open(letter: str) -> bool:
    return letter in VOWELS or letter in GLIDES


def _joined(before: Phoneme | None, sound: Phoneme, after: Phoneme | None) -> Phoneme:
    """Lets a sound begin where the one before it is let go, and end where the next one begins to be made."""
    onset, release = sound.made
    if before is not None and sound.start - before.end < NO_PAUSE:
        onset = min(onset, max(before.made))
    if after is not None:
        release = max(onset, min(release, after.made[0]))
    return replace(sound, onset=onset, release=release)
