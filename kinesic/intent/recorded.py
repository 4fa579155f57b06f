"""Behaviours that follow the word times and accents of a recording."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from kinesic.expressivity.style.style import Style
from kinesic.intent.behaviour_sets import BehaviourSets
from kinesic.intent.behaviours import Selection
from kinesic.intent.budget import budget_of
from kinesic.intent.choosing import choose_behaviours
from kinesic.intent.intents import Intent, Moment
from kinesic.intent.markup import quote
from kinesic.intent.reading.passage import SPEECH_ID, Passage

ACCENT_INTENT = "accent"  # intent of a beat, a nod or raised brows
ACCENT_CERTAINTY = 0.4  # certainty of an accent that is heard
ACCENT_LEAD = 0.1  # [s] from start to stroke, and from stroke to end of an accent
MIN_STROKE_TIME = 0.55  # [s] earliest stroke that a hand can reach


@dataclass(frozen=True, eq=False)
class RecordedAudio:
    """Recording of a spoken text, and a reader of its word times."""

    audio: str  # name of the sound file in the BML
    words: str  # name of the file with the times of words; empty: none
    hear: Callable[[Passage], Passage]  # adds the times and accents of the recording

    def write(self) -> str:
        """Return the BML description of the recording."""
        words = f" kinesic:words={quote(self.words)}" if self.words else ""
        return f'<description priority="1" type="audio/wav"><audio ref={quote(self.audio)}{words}/></description>'


def choose_accent_behaviours(
    accents: Sequence[float], duration: float, style: Style, sets: BehaviourSets, *, seed: int = 0
) -> Selection:
    """Choose beats, nods and brows for accents of speech without text.

    Args:
        accents: times of accents in the speech [s].
        duration: of the speech [s].
        style: of the performance.
        sets: behaviours by intent.
        seed: of the random choice.
    """
    intents = [
        Intent(
            ACCENT_INTENT,
            Moment(f"{SPEECH_ID}:start+{max(time - ACCENT_LEAD, 0.0):.2f}", max(time - ACCENT_LEAD, 0.0)),
            Moment(f"{SPEECH_ID}:start+{time:.2f}", time),
            Moment(f"{SPEECH_ID}:start+{time + ACCENT_LEAD:.2f}", time + ACCENT_LEAD),
            ACCENT_CERTAINTY,
            f"an accent is heard at {time:.2f} s",
        )
        for time in accents
        if time >= MIN_STROKE_TIME
    ]
    return choose_behaviours(intents, sets, budget_of(duration, style), seed=seed)
