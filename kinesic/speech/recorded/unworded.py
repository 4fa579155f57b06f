"""Lip sounds and accents of a recording without text."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, find_runs
from kinesic.body.utterance import STRESS_MARKS, Phoneme, Sound
from kinesic.speech.recorded.activity import find_speech
from kinesic.speech.recorded.loudness import compute_openings, estimate_pitch
from kinesic.speech.recorded.peaks import average_frames, find_peaks
from kinesic.speech.recorded.spectrum import FRAME_PERIOD, compute_band_powers, compute_levels

SMOOTHING_FRAMES = 5  # [frames] length of the moving mean of spectra, so that lips do not flicker
# Upper edges of the low, middle and high bands: about 430 Hz, 1300 Hz and 3300 Hz.
LOW_BANDS = slice(0, 5)  # indices of the lowest frequency bands
MIDDLE_BANDS = slice(5, 12)  # indices of the bands above LOW_BANDS
HIGH_BANDS = slice(12, 19)  # indices of the bands between MIDDLE_BANDS and HISS_BANDS
HISS_BANDS = slice(19, 26)  # indices of the bands of hissing sounds, above about 3300 Hz
HISS_FRACTION = 0.5  # fraction of the power in HISS_BANDS above which a sound hisses
OPEN_RATIO = 1.8  # power of the middle / low bands above which the mouth is open
FRONT_RATIO = 0.6  # power of the high / low bands above which the lips are spread
ROUND_RATIO = 0.6  # power of the middle / low bands below which unspread lips are rounded
CLOSURE_DEPTH = 9.0  # [dB] depth of a dip below both neighbouring peaks at which the lips close
MIN_SOUND_FRAMES = 4  # [frames] shortest sound; a shorter one is lengthened
PEAK_DEPTH = 3.0  # [dB] smallest prominence of a syllable's peak of loudness
SYLLABLE_FRAMES = 12  # [frames] smallest distance of two syllables' peaks
CONTEXT_FRAMES = 200  # [frames] context before and after a syllable to which the syllable is compared
LEVEL_UNIT = 4.0  # [dB] rise of the level that counts as one unit of prominence
PITCH_UNIT = 2.5  # [semitones] rise of the pitch that counts as one unit of prominence
MIN_PROMINENCE = 0.8  # prominence from which a syllable has an accent
ACCENT_FRAMES = 40  # [frames] smallest distance of two accents


def lip_sounds(sound: Sound) -> tuple[Phoneme, ...]:
    """Return approximate sounds of speech without text, with stress on its accents."""
    powers = compute_band_powers(sound)
    levels = compute_levels(powers)
    is_speech = find_speech(levels)
    if not is_speech.any():
        return ()
    symbols = _classify(powers, levels, is_speech)
    openings = compute_openings(levels, is_speech)
    sounds = list(_join(symbols, openings, is_speech))
    accents: Floats = FRAME_PERIOD * _find_accents(levels, estimate_pitch(sound), is_speech).astype(np.float64)
    return tuple(_stress(sounds, accents))


def _classify(powers: Floats, levels: Floats, is_speech: Flags) -> Indices:
    """Return the index into SOUND_SYMBOLS of each frame, shape (n,)."""
    smooth = average_frames(powers, SMOOTHING_FRAMES) + 1e-12
    bands = (LOW_BANDS, MIDDLE_BANDS, HIGH_BANDS, HISS_BANDS)
    low, middle, high, hiss = (smooth[:, columns].sum(axis=1) for columns in bands)
    kinds = np.full(len(levels), SOUND_SYMBOLS.index("ə"))
    kinds[middle < ROUND_RATIO * low] = SOUND_SYMBOLS.index("u")
    kinds[high > FRONT_RATIO * low] = SOUND_SYMBOLS.index("e")
    kinds[middle > OPEN_RATIO * low] = SOUND_SYMBOLS.index("a")
    kinds[hiss > HISS_FRACTION * (low + middle + high + hiss)] = SOUND_SYMBOLS.index("s")
    smooth_levels = average_frames(levels, SMOOTHING_FRAMES)
    dips = find_peaks(-smooth_levels, prominence=CLOSURE_DEPTH)
    for dip in dips:
        if is_speech[dip]:
            kinds[max(dip - 2, 0) : dip + 3] = SOUND_SYMBOLS.index("m")
    return kinds


SOUND_SYMBOLS = ("ə", "u", "e", "a", "s", "m")  # symbols of the distinguished sounds


def _join(symbols: Indices, openings: Floats, is_speech: Flags) -> Iterator[Phoneme]:
    """Yield a sound for each run of speech frames with one symbol.

    A sound has at least `MIN_SOUND_FRAMES` frames, except before a pause.
    """
    for begin, end in find_runs(is_speech):
        edges = [begin]
        for k in range(begin + 1, end):
            if symbols[k] != symbols[edges[-1]] and k - edges[-1] >= MIN_SOUND_FRAMES:
                edges.append(k)
        for first, last in zip(edges, [*edges[1:], end], strict=True):
            symbol = SOUND_SYMBOLS[int(symbols[first])]
            opening = round(float(openings[first:last].mean()), 3)
            yield Phoneme(symbol, FRAME_PERIOD * first, FRAME_PERIOD * (last - first), opening=opening)


def _find_accents(levels: Floats, pitch: Floats, is_speech: Flags) -> Indices:
    """Return the frames of accented syllables."""
    smooth = average_frames(levels, SMOOTHING_FRAMES)
    peaks = find_peaks(smooth, distance=SYLLABLE_FRAMES, prominence=PEAK_DEPTH)
    peaks = peaks[is_speech[peaks]]
    semitones = 12.0 * np.log2(pitch)
    highest = np.array([_max_near(semitones, int(peak)) for peak in peaks])
    scores = np.zeros(len(peaks))
    for k, peak in enumerate(peaks):
        near = np.abs(peaks - peak) <= CONTEXT_FRAMES
        voiced = highest[near][~np.isnan(highest[near])]
        scores[k] = (smooth[peak] - smooth[peaks[near]].mean()) / LEVEL_UNIT
        if len(voiced) and not np.isnan(highest[k]):
            scores[k] += (highest[k] - voiced.mean()) / PITCH_UNIT
    accents: list[int] = []
    for k in np.argsort(-scores):
        if scores[k] >= MIN_PROMINENCE and all(abs(int(peaks[k]) - other) >= ACCENT_FRAMES for other in accents):
            accents.append(int(peaks[k]))
    return np.array(sorted(accents), dtype=np.intp)


def _max_near(semitones: Floats, frame: int) -> float:
    near = semitones[max(frame - SMOOTHING_FRAMES, 0) : frame + SMOOTHING_FRAMES + 1]
    voiced = near[~np.isnan(near)]
    return float(np.median(voiced)) if len(voiced) else np.nan


def _stress(sounds: list[Phoneme], accents: Floats) -> Iterator[Phoneme]:
    """Yield the sounds, with primary stress on accented vowels, secondary on others."""
    for sound in sounds:
        is_vowel = sound.symbol in ("ə", "u", "e", "a")
        has_accent = is_vowel and bool(np.any((accents >= sound.start) & (accents < sound.end)))
        mark = STRESS_MARKS[0] if has_accent else STRESS_MARKS[1] if is_vowel else ""
        yield replace(sound, symbol=mark + sound.symbol)
