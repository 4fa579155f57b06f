"""Memory of chosen gestures, which lasts across turns."""

from collections.abc import Callable, Collection, Iterable, Sequence
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
    clips: tuple[PastGesture, ...] = ()  # captured gestures that were performed in place of others

    @property
    def times(self) -> tuple[float, ...]:
        """Stroke times of the remembered gestures, in total speaking time [s]."""
        return tuple(gesture.seconds for gesture in self.gestures)

    def list_clips(self, since: float = 0.0) -> tuple[PastGesture, ...]:
        """Return the remembered captured gestures on the clock of the next text.

        Args:
            since: time of its first word, on the clock of its behaviours [s].
        """
        return tuple(replace(clip, seconds=clip.seconds - self.seconds + since) for clip in self.clips)

    def extend(
        self,
        behaviours: Iterable[ChosenBehaviour],
        duration: float,
        *,
        since: float = 0.0,
        replaced: Collection[ChosenBehaviour] = (),
        pause: float = TURN_PAUSE,
        written: Iterable[ChosenBehaviour] = (),
    ) -> "ChoiceMemory":
        """Return the memory extended by the gestures of further text.

        Args:
            behaviours: chosen for the text.
            duration: of the text [s].
            since: time of its first word, on the clock of the behaviours [s].
            replaced: earlier behaviours that are not performed.
            pause: silence after it [s].
            written: the behaviours, with captured gestures in place of some.
        """
        new = (self._date(behaviour, since) for behaviour in behaviours if behaviour.channel == "gesture")
        clips = (self._date(behaviour, since) for behaviour in written if behaviour.captured)
        now = self.seconds + duration + pause

        def keep_recent(gestures: Iterable[PastGesture]) -> tuple[PastGesture, ...]:
            return tuple(gesture for gesture in gestures if now - gesture.seconds < REPEAT_WINDOW)

        gestures = keep_recent((*self.forget(replaced).gestures, *new))
        return ChoiceMemory(gestures, now, self.parts + 1, keep_recent((*self.clips, *clips)))

    def _date(self, behaviour: ChosenBehaviour, since: float) -> PastGesture:
        """Return a memory entry of a gesture in total speaking time."""
        seconds = self.seconds + behaviour.intent.stroke.seconds - since
        return PastGesture(behaviour.form, seconds, behaviour.intent.reason)

    def forget(self, replaced: Collection[ChosenBehaviour]) -> "ChoiceMemory":
        """Return the memory without gestures that were not performed."""
        dropped = {(behaviour.form, behaviour.intent.reason) for behaviour in replaced}
        kept = tuple(gesture for gesture in self.gestures if (gesture.form, gesture.reason) not in dropped)
        return replace(self, gestures=kept) if dropped else self


NO_MEMORY = ChoiceMemory()  # memory before the first text

Revision = Callable[
    [Sequence[ChosenBehaviour], Sequence[PastGesture]], Sequence[ChosenBehaviour]
]  # replaces gestures of a text by captured ones, given the captured gestures of earlier texts
