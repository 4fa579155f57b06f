"""Memory of chosen gestures, which lasts across turns."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

from kinesic.intent.behaviours import ChosenBehaviour

REPEAT_WINDOW = 60.0  # [s] duration of speech within which no gesture is repeated
TURN_PAUSE = 1.0  # [s] silence assumed between two texts


@dataclass(frozen=True)
class PastGesture:
    """Gesture of an earlier text, with its time and reason."""

    form: str  # lexeme, with the hand if the intent chose a hand
    seconds: float  # [s] time of the stroke in total speaking time
    reason: str  # words and their meaning; an equal reason means that the text repeats these words


@dataclass(frozen=True)
class ChoiceMemory:
    """Gestures of the last minute of speech, in order of choice.

    Its clock counts speech, not the time between turns, so that the same texts give the same gestures.
    """

    gestures: tuple[PastGesture, ...] = ()
    seconds: float = 0.0  # [s] duration of speech so far
    parts: int = 0  # number of texts and parts of streamed texts so far

    @property
    def times(self) -> tuple[float, ...]:
        """Stroke times of the remembered gestures, in total speaking time [s]."""
        return tuple(gesture.seconds for gesture in self.gestures)

    def extend(
        self,
        behaviours: Iterable[ChosenBehaviour],
        duration: float,
        *,
        since: float = 0.0,
        replaced: Collection[ChosenBehaviour] = (),
        pause: float = TURN_PAUSE,
    ) -> "ChoiceMemory":
        """Return the memory extended by the gestures of further text.

        Args:
            behaviours: chosen for the text.
            duration: of the text [s].
            since: time of its first word, on the clock of the behaviours [s].
            replaced: earlier behaviours that are not performed.
            pause: silence after it [s].
        """
        new = [
            PastGesture(behaviour.form, self.seconds + behaviour.intent.stroke.seconds - since, behaviour.intent.reason)
            for behaviour in behaviours
            if behaviour.channel == "gesture"
        ]
        now = self.seconds + duration + pause
        kept = [item for item in (*self.forget(replaced).gestures, *new) if now - item.seconds < REPEAT_WINDOW]
        return ChoiceMemory(tuple(kept), now, self.parts + 1)

    def forget(self, replaced: Collection[ChosenBehaviour]) -> "ChoiceMemory":
        """Return the memory without gestures that were not performed."""
        dropped = {(behaviour.form, behaviour.intent.reason) for behaviour in replaced}
        kept = tuple(gesture for gesture in self.gestures if (gesture.form, gesture.reason) not in dropped)
        return replace(self, gestures=kept) if dropped else self


NO_MEMORY = ChoiceMemory()  # memory before the first text
