"""Finds how long the accented syllable of a word lasts beyond a sync point that a document ties to the word."""

from collections.abc import Mapping, Sequence
from itertools import takewhile

from kinesic.bml.block import Block
from kinesic.bml.timing.words import tied_words
from kinesic.body.utterance import STRESSES, VOWELS, Phoneme, Utterance

WORD = 0.7  # [s] behind the place of a mark, in which the accented syllable of its word begins
ACCENTS = (*STRESSES, "")  # of vowels, the strongest first
ROUNDING = 1e-6  # [s]


def find_syllables(block: Block, utterances: Mapping[str, Utterance]) -> Mapping[tuple[str, str], float]:
    """Finds when the accented syllable ends [s], from the sync point on.

    Args:
        block: with its speeches.
        utterances: of them, by their ids.

    Returns:
        (behaviour, sync point) -> [s]; without those whose syllable is over by then, or whose sounds nobody knows.
    """
    found: dict[tuple[str, str], float] = {}
    for point, (word, offset) in tied_words(block).items():
        said = utterances.get(word.behaviour)
        begins = 0.0 if said is None else said.marks.get(word.sync, 0.0)
        ends = None if said is None else syllable_end(said.phonemes, begins)
        if ends is not None and ends - begins > offset:
            found[point.behaviour, point.sync] = ends - begins - offset
    return found


def syllable_end(phonemes: Sequence[Phoneme], begins: float) -> float | None:
    """Finds when the accented vowel of a word ends [s]; None where it has none.

    Args:
        phonemes: of the utterance, in their order.
        begins: when the word does [s].
    """
    near = [each for each in phonemes if -ROUNDING <= each.start - begins <= WORD]
    vowels = [k for k, each in enumerate(near) if _is_vowel(each)]
    for stress in ACCENTS:
        accented = next((k for k in vowels if near[k].symbol.startswith(stress)), None)
        if accented is not None:
            *_, last = takewhile(_is_vowel, near[accented:])
            return last.end
    return None


def accented_vowels(phonemes: Sequence[Phoneme]) -> list[float]:
    """Finds the middle of each accented vowel [s]; of every vowel, where the voice tells no accents."""
    vowels = [each for each in phonemes if _is_vowel(each)]
    accented = [each for each in vowels if each.symbol.startswith(STRESSES[0])] or vowels
    return [each.start + each.duration / 2 for each in accented]


def _is_vowel(sound: Phoneme) -> bool:
    return sound.symbol.lstrip("".join(STRESSES))[:1].lower() in VOWELS
