"""Times from word-tied sync points to the ends of accented vowels."""

from collections.abc import Mapping, Sequence
from itertools import takewhile

from kinesic.bml.block import Block
from kinesic.bml.timing.words import find_word_offsets
from kinesic.body.utterance import STRESS_MARKS, VOWEL_LETTERS, Phoneme, Utterance

MAX_ACCENT_DELAY = 0.7  # [s] longest time from a mark to the accented vowel of its word
STRESS_LEVELS = (*STRESS_MARKS, "")  # stress marks before a vowel: primary, secondary, none
TIME_ROUNDING = 1e-6  # [s] tolerance for phonemes that start just before a mark


def find_syllables(block: Block, utterances: Mapping[str, Utterance]) -> Mapping[tuple[str, str], float]:
    """Return times [s] from word-tied sync points to ends of accented vowels.

    Args:
        block: block with its speeches.
        utterances: utterance by speech id.

    Returns:
        (behaviour, sync point) -> [s]; without syllables that end earlier, or whose phonemes are unknown.
    """
    delays: dict[tuple[str, str], float] = {}
    for point, (word, offset) in find_word_offsets(block).items():
        utterance = utterances.get(word.behaviour)
        start = 0.0 if utterance is None else utterance.marks.get(word.sync, 0.0)
        end = None if utterance is None else find_syllable_end(utterance.phonemes, start)
        if end is not None and end - start > offset:
            delays[point.behaviour, point.sync] = end - start - offset
    return delays


def find_syllable_end(phonemes: Sequence[Phoneme], start: float) -> float | None:
    """Return the end of a word's accented vowel [s], or None.

    Args:
        phonemes: phonemes of the utterance in order.
        start: start of the word [s].
    """
    candidates = [phoneme for phoneme in phonemes if -TIME_ROUNDING <= phoneme.start - start <= MAX_ACCENT_DELAY]
    vowels = [k for k, phoneme in enumerate(candidates) if _is_vowel(phoneme)]
    for stress in STRESS_LEVELS:
        accented = next((k for k in vowels if candidates[k].symbol.startswith(stress)), None)
        if accented is not None:
            *_, last = takewhile(_is_vowel, candidates[accented:])
            return last.end
    return None


def find_accented_vowels(phonemes: Sequence[Phoneme]) -> list[float]:
    """Return the middle times [s] of the vowels with primary stress.

    Without any, those of all vowels.
    """
    vowels = [phoneme for phoneme in phonemes if _is_vowel(phoneme)]
    accented = [phoneme for phoneme in vowels if phoneme.symbol.startswith(STRESS_MARKS[0])] or vowels
    return [phoneme.start + phoneme.duration / 2 for phoneme in accented]


def _is_vowel(sound: Phoneme) -> bool:
    return sound.symbol.lstrip("".join(STRESS_MARKS))[:1].lower() in VOWEL_LETTERS
