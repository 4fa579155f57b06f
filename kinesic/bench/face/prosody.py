"""Benchmark of motion by prosody: accents with brows or nods, and blinks."""

from collections.abc import Mapping

import numpy as np

from kinesic.bml.timing.syllables import find_accented_vowels
from kinesic.body.utterance import Script, Voice
from kinesic.expressivity.face.blinks import blink_times
from kinesic.expressivity.prosody import Accent, choose_accents, find_phrase_ends

STORY_TEXT = (
    "Tomorrow we take the early train to the coast, and then we walk for an hour along the cliffs. The weather should "
    "be fine. My sister brings the sandwiches, but she never remembers the water, so please fill two bottles before "
    "you leave. We had a small dog when I was a child, and he came with us on every walk. He was afraid of the sea! "
    "Each time a wave came in, he ran back to my father, sat down behind him, and waited until it was gone."
)
STORY_SEEDS = range(10)  # random seeds with which the story is performed
BLINK_MINUTES = 10  # [min] duration of the repeated story in which blinks are counted
MINUTE_DURATION = 60.0  # [s] seconds per minute


def measure_prosody(voice: Voice) -> Mapping[str, float]:
    """Measure accents with motion [%], raised brows and blinks per minute."""
    script = Script(STORY_TEXT)
    utterance = voice.say(script)
    accents = utterance.accents or find_accented_vowels(utterance.phonemes)
    chosen = [choose_accents("story", utterance, script, seed) for seed in STORY_SEEDS]
    ends = np.array(find_phrase_ends(utterance))
    repeats = np.arange(0.0, BLINK_MINUTES * MINUTE_DURATION, utterance.duration)
    causes = (repeats[:, None] + ends).ravel().tolist()
    counts: list[int] = []
    for seed in STORY_SEEDS:
        begins = np.array(blink_times((0.0, BLINK_MINUTES * MINUTE_DURATION), (), seed, also=causes))
        counts += np.histogram(begins, np.arange(BLINK_MINUTES + 1) * MINUTE_DURATION)[0].tolist()
    return {
        "face.prosody.accents_moved": 100.0 * float(np.mean([len(part) / len(accents) for part in chosen])),
        "face.prosody.brows": MINUTE_DURATION
        * float(np.mean([_count_brows(part) for part in chosen]))
        / utterance.duration,
        "face.prosody.blinks_fewest": float(min(counts)),
        "face.prosody.blinks_most": float(max(counts)),
    }


def _count_brows(accents: tuple[Accent, ...]) -> int:
    return sum(accent.brow > 0.0 for accent in accents)
