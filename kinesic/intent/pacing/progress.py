"""Progress of a streamed text: spoken words and shown gestures."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from kinesic.expressivity.style.style import Style
from kinesic.intent.behaviours import ChosenBehaviour
from kinesic.intent.budget import MovementBudget, budget_of
from kinesic.intent.pacing.rhythm import is_beat


@dataclass(frozen=True)
class Progress:
    """Counts of words and gestures, and duration, of a text's spoken parts."""

    words: int = 0
    seconds: float = 0.0  # [s] estimated duration of these words and their pauses
    gestures: int = 0
    pictures: int = 0  # number of gestures other than beats

    def budget(self, duration: float, style: Style, free: Iterable[ChosenBehaviour]) -> MovementBudget:
        """Return the remaining gesture budget for the next part of a text.

        Args:
            duration: of the next part [s].
            style: of the performance.
            free: shown behaviours that may be replaced, which the remainder includes.
        """
        total, (gestures, pictures) = budget_of(self.seconds + duration, style), _count(free)
        return replace(
            total,
            gestures=max(total.gestures - self.gestures + gestures, 0),
            pictures=max(total.pictures - self.pictures + pictures, 0),
        )

    def extend(
        self, words: int, duration: float, shown: Iterable[ChosenBehaviour], replaced: Sequence[ChosenBehaviour]
    ) -> "Progress":
        """Return the progress after one more part of the text.

        Args:
            words: of the part.
            duration: of these words and the pause after them [s].
            shown: behaviours of the part.
            replaced: earlier behaviours that are not performed.
        """
        (gestures, pictures), (fewer, fewer_pictures) = _count(shown), _count(replaced)
        return Progress(
            self.words + words,
            self.seconds + duration,
            self.gestures + gestures - fewer,
            self.pictures + pictures - fewer_pictures,
        )


def _count(behaviours: Iterable[ChosenBehaviour]) -> tuple[int, int]:
    """Count all chosen gestures, and those that are not beats."""
    hands = [behaviour for behaviour in behaviours if behaviour.channel == "gesture"]
    return len(hands), sum(not is_beat(hand.lexeme) for hand in hands)


NO_PROGRESS = Progress()  # progress before the first word of a text
