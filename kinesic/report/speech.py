"""Voices and phoneme times in a report."""

from typing import TYPE_CHECKING

from kinesic.body.utterance import Utterance
from kinesic.planning.plan import Plan

if TYPE_CHECKING:
    from kinesic.report.report import Json  # which has this list

PHONEME_TIME_KEYS = ("start_s", "end_s", "onset_s", "release_s")  # keys of phoneme times in report.json


def describe_speech(plan: Plan) -> "list[Json]":
    """Return each speech with its voice, audibility and phoneme times."""
    starts = {timed.behaviour.id: timed.times["start"] for timed in plan.timeline.timed if "start" in timed.times}
    return [
        {
            "id": name,
            "voice": utterance.voice,
            "duration_s": utterance.duration,
            "heard": utterance.sound is not None,
            "phonemes": _phonemes(utterance, starts.get(name, 0.0)),
        }
        for name, utterance in plan.utterances.items()
    ]


def _phonemes(utterance: Utterance, start: float) -> "list[Json]":
    """Return each phoneme's sound and articulation times."""
    phonemes: list[Json] = []
    for sound in utterance.phonemes:
        times = (sound.start, sound.end, *sound.articulation)
        phonemes.append(
            {"symbol": sound.symbol}
            | {name: round(start + time, 4) for name, time in zip(PHONEME_TIME_KEYS, times, strict=True)}
        )
    return phonemes
