"""Times of sounds from the durations of hibari's letters.

The boundaries that the model's durations describe lie later than those in its sound, by a constant that depends on the
sound and on its place in a word. The constants below were measured on bursts, closures and the ends of nasals in the
model's own audio, in 40 sentences at rates of 0.8, 1 and 1.25; they do not depend on the rate.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.utterance import STRESS_MARKS, VOWEL_LETTERS, Phoneme, Samples
from kinesic.speech.engines.audible import SILENCE_RATIO
from kinesic.speech.hibari.model import SAMPLE_RATE, UNIT_DURATION, Prediction
from kinesic.speech.hibari.pronunciation import SIGN_LETTERS

IPA_SYMBOLS: Mapping[str, str] = {  # letters of hibari that differ from the phonetic alphabet
    **{"A": "eɪ", "I": "aɪ", "O": "oʊ", "Q": "əʊ", "W": "aʊ", "Y": "ɔɪ", "ᵊ": "ə"},  # noqa: RUF001 - phonetic letters
    **{"ʣ": "dz", "ʤ": "dʒ", "ʥ": "dʑ", "ʦ": "ts", "ʧ": "tʃ", "ʨ": "tɕ", "ꭧ": "tʂ", "S": "s", "T": "ɾ"},
}
DIPHTHONG_LETTERS = frozenset("AIOQWY")  # letters with which the voice hibari writes a diphthong as one symbol
MODIFIER_LETTERS = frozenset("\u02d0\u02b0\u02b2\u0303")  # letters that change the sound before them
INITIAL_ONSET_SHIFT = -0.090  # [s] from the start of a word's first consonant to its closure or constriction
SIBILANT_ONSET_SHIFT = -0.105  # [s] from the start of a word's first sibilant to its constriction
ONSET_SHIFT = -0.060  # [s] from the start of any other sound to its onset
BURST_SHIFTS: Mapping[str, tuple[float, float]] = {  # [s] from a stop's start to its burst: first in a word, elsewhere
    **{"p": (-0.040, -0.006), "t": (-0.052, -0.018), "k": (-0.047, -0.015), "ʧ": (-0.047, -0.018)},
    **{"b": (-0.027, -0.020), "d": (-0.034, -0.018), "\u0261": (-0.040, -0.020), "ʤ": (-0.034, -0.018)},
}
AFFRICATE_LETTERS = frozenset("ʧʤʦʣ")  # stops that continue as a fricative
SIBILANT_LETTERS = frozenset("sʃzʒ")  # hissing fricatives
NASAL_LETTERS = frozenset("mnŋ")  # nasal consonants
NASAL_RELEASE_SHIFT = 0.0  # [s] from a nasal's start to its release before a vowel or glide
OPEN_LETTERS = (
    VOWEL_LETTERS | DIPHTHONG_LETTERS | frozenset("ᵊlɹwj")
)  # letters before which a nasal is released audibly
CLOSURE_LEAD = 0.010  # [s] from closing lips or tongue to the audible closure of a stop or nasal
MIN_SILENCE = 0.06  # [s] shortest quiet span that counts as silence
MIN_SOUND = 0.005  # [s] shortest duration of a placed sound

Span = tuple[float, float]  # begin and end [s]


@dataclass(frozen=True)
class _Unit:
    """Sound with its index in the phoneme letters."""

    symbol: str  # sound in the phonetic alphabet, with its stress mark
    letter: str  # letter of the model, without stress mark
    index: int  # index of the sound's first letter
    begin: float  # [s] start according to the predicted durations
    is_initial: bool  # whether the sound starts a word
    follows_sign: bool  # whether punctuation lies before the sound

    @property
    def onset(self) -> float:
        """Time [s] at which the sound's closure or constriction begins."""
        if not self.is_initial or self.letter in VOWEL_LETTERS | DIPHTHONG_LETTERS:
            return self.begin + ONSET_SHIFT
        return self.begin + (SIBILANT_ONSET_SHIFT if self.letter in SIBILANT_LETTERS else INITIAL_ONSET_SHIFT)

    @property
    def start(self) -> float:
        """Time [s] of the burst, or of the onset without a burst."""
        shifts = BURST_SHIFTS.get(self.letter)
        return self.onset if shifts is None else self.begin + shifts[0 if self.is_initial else 1]

    @property
    def closure(self) -> float:
        """Duration [s] from reaching the mouth shape to the start."""
        is_closed = self.letter in BURST_SHIFTS or self.letter in NASAL_LETTERS
        return max(self.start - self.onset, 0.0) + (CLOSURE_LEAD if is_closed else 0.0)


def place_phonemes(letters: str, prediction: Prediction) -> tuple[tuple[Phoneme, ...], tuple[int, ...]]:
    """Return the phonemes of a phrase with their first letter indices.

    A stop starts with its burst, any other sound with its audible onset. The mouth shape of a stop or nasal reaches
    from its closure to its release.

    Args:
        letters: as predicted.
        prediction: sound and durations of these letters.
    """
    units = list(_read_units(letters, prediction))
    if not units:
        return (), ()
    silences = find_silences(prediction.samples)
    spans = _place_units(units, silences)
    onsets = [start - unit.closure for unit, (start, _) in zip(units, spans, strict=True)]
    releases = [_find_release(units, spans, onsets, number) for number in range(len(units))]
    phonemes = tuple(
        Phoneme(unit.symbol, start, end - start, onset, max(release, onset + MIN_SOUND))
        for unit, (start, end), onset, release in zip(units, spans, onsets, releases, strict=True)
    )
    return phonemes, tuple(unit.index for unit in units)


def find_silences(samples: Samples) -> tuple[Span, ...]:
    """Return silent spans [s] of at least `MIN_SILENCE`."""
    amplitudes = np.abs(samples)
    audible = np.flatnonzero(amplitudes > SILENCE_RATIO * float(amplitudes.max(initial=0.0)))
    edges = np.concatenate([[-1], audible, [len(samples)]])
    wide = np.flatnonzero(np.diff(edges) > MIN_SILENCE * SAMPLE_RATE)
    return tuple((float(edges[k] + 1) / SAMPLE_RATE, float(edges[k + 1]) / SAMPLE_RATE) for k in wide)


def _read_units(letters: str, prediction: Prediction) -> Iterator[_Unit]:
    """Yield the sounds of phoneme letters, with their stress marks."""
    begins = np.concatenate([[0.0], np.cumsum(prediction.durations)]) * UNIT_DURATION
    index, is_initial, follows_sign = 0, True, True
    while index < len(letters):
        first = index
        while index < len(letters) and letters[index] in STRESS_MARKS:
            index += 1
        if index == len(letters):
            return
        letter = letters[index]
        index += 1
        if letter in SIGN_LETTERS:
            is_initial, follows_sign = True, follows_sign or letter != " "
            continue
        symbol = letters[first : index - 1] + IPA_SYMBOLS.get(letter, letter)
        while index < len(letters) and letters[index] in MODIFIER_LETTERS:
            symbol += letters[index]
            index += 1
        yield _Unit(symbol, letter, first, float(begins[first + 1]), is_initial, follows_sign)
        is_initial, follows_sign = False, False


def _place_units(units: list[_Unit], silences: tuple[Span, ...]) -> list[Span]:
    """Return start and end [s] of each sound, excluding silences."""
    starts: list[float] = []
    ends: list[float] = []
    for number, unit in enumerate(units):
        earliest = starts[-1] + MIN_SOUND if starts else 0.0
        start = max(unit.start, earliest)
        end_of_previous = start
        if unit.follows_sign:
            after = units[number + 1].begin if number + 1 < len(units) else unit.begin + UNIT_DURATION
            begin = units[number - 1].onset if number else -1.0
            inside = [span for span in silences if span[1] > begin and span[0] >= begin and span[1] <= after]
            if inside:
                silence = max(inside, key=lambda span: span[1] - span[0])
                start = max(silence[1], earliest)
                end_of_previous = min(max(silence[0], earliest), start)
        if ends:
            ends[-1] = end_of_previous
        starts.append(start)
        ends.append(start)
    final = [begin for begin, _ in silences[-1:] if begin > starts[-1]]
    ends[-1] = max([*final, starts[-1] + MIN_SOUND])
    return list(zip(starts, ends, strict=True))


def _find_release(units: list[_Unit], spans: list[Span], onsets: list[float], number: int) -> float:
    """Return the time [s] when the mouth leaves a sound's shape."""
    unit, (start, end) = units[number], spans[number]
    if unit.letter in BURST_SHIFTS and unit.letter not in AFFRICATE_LETTERS:
        return start
    if number + 1 == len(units) or spans[number + 1][0] > end:
        return end
    if unit.letter in NASAL_LETTERS and units[number + 1].letter in OPEN_LETTERS:
        return min(max(unit.begin + NASAL_RELEASE_SHIFT, start + MIN_SOUND), max(onsets[number + 1], end))
    return min(onsets[number + 1], end)
