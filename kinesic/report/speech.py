"""What is said, for the report: who says it, and when each of its sounds is made."""

from typing import TYPE_CHECKING

from kinesic.body.utterance import Utterance
from kinesic.planning.plan import Plan

if TYPE_CHECKING:
    from kinesic.report.report import Json  # which has this list

TIMES = ("start_s", "end_s", "onset_s", "release_s")


def describe_speech(plan: Plan) -> "list[Json]":
    """Lists who says what is said, whether it is heard, and its sounds on the clock of the sync points."""
    starts = {timed.behaviour.id: timed.times["start"] for timed in plan.timeline.timed if "start" in timed.times}
    return [
        {
            "id": name,
            "voice": said.voice,
            "duration_s": said.duration,
            "heard": said.sound is not None,
            "phonemes": _phonemes(said, starts.get(name, 0.0)),
        }
        for name, said in plan.utterances.items()
    ]


def _phonemes(said: Utterance, start: float) -> "list[Json]":
    """When each sound begins and ends in the voice, and when the mouth has come to it and lets it go."""
    found: list[Json] = []
    for sound in said.phonemes:
        times = (sound.start, sound.end, *sound.made)
        found.append(
            {"symbol": sound.symbol} | {name: round(start + time, 4) for name, time in zip(TIMES, times, strict=True)}
        )
    return found
