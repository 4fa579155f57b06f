"""Beats on accents, in runs between the other gestures."""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence

from kinesic.intent.pacing.accents import RHYTHM_INTENT
from kinesic.intent.pacing.candidates import Candidate
from kinesic.intent.pacing.tempo import RUN_SPACING, Tempo

MAIN_BEAT_INTENT = "accent"  # intent of the main accent of a phrase
BEAT_INTENTS = frozenset({MAIN_BEAT_INTENT, RHYTHM_INTENT})  # intents whose gestures are beats
BEAT_PREFIX = "beat"  # start of the ids of all beats in the lexicon
INITIAL_DUE_STROKES = 0.3  # strokes that are already due at the first word of a text
RUN_START_STROKES = 0.3  # number of due strokes at which a run of beats begins
MAX_SURPLUS_STROKES = 0.7  # strokes ahead of the rate up to which a run of beats continues
TEXT_END_FRACTION = 0.5  # time assumed from the last accent to the next stroke / mean interval of strokes
LOOK_AHEAD_TIME = 4.0  # [s] time ahead in which coming gestures count as strokes already made
CHOICE_WINDOW = 0.5  # [s] time after an accent within which a stronger accent gets the beat


def is_beat(lexeme: str) -> bool:
    """Return whether a gesture is a beat."""
    return lexeme.startswith(BEAT_PREFIX)


def place_beats(
    accents: Sequence[Candidate],
    strokes: Sequence[float],
    tempo: Tempo,
    *,
    since: float = 0.0,
    earlier_strokes: int = 0,
    earlier_seconds: float = 0.0,
) -> list[Candidate]:
    """Choose accents for beats, so that strokes come in runs.

    Args:
        accents: candidates on accented words.
        strokes: times of all other gestures [s].
        tempo: rate and grouping of strokes.
        since: time of the first word [s].
        earlier_strokes: strokes before this word.
        earlier_seconds: speech before this word [s].
    """
    ordered = sorted(accents, key=lambda each: each.intent.stroke.seconds)
    times = [item.intent.stroke.seconds for item in ordered]
    others = sorted(strokes)
    run = _Run(others, tempo, since, earlier_seconds, earlier_strokes)
    kept = list[Candidate]()
    for k, (accent, at) in enumerate(zip(ordered, times, strict=True)):
        stop = bisect_right(times, at + CHOICE_WINDOW)
        is_weaker = any(
            ordered[j].weight > accent.weight and run.has_space(times[j]) for j in range(k + 1, min(stop, k + 8))
        )
        if not is_weaker and run.has_space(at) and run.is_due(at, times[k + 1] if k + 1 < len(times) else float("inf")):
            run.beats.append(at)
            kept.append(accent)
    return kept


class _Run:
    """Beats already chosen, with the strokes of all other gestures."""

    def __init__(self, others: Sequence[float], tempo: Tempo, since: float, seconds: float, strokes: int) -> None:
        self._others, self._tempo, self._since = others, tempo, since
        self._seconds, self._strokes = seconds, strokes
        self._first = bisect_left(others, since)  # earlier strokes are counted in `strokes`
        self.beats: list[float] = []  # [s] times of the chosen beats

    def has_space(self, at: float) -> bool:
        """Return whether a stroke keeps the minimum interval to all other strokes."""
        spacing = self._tempo.beat_spacing
        return at - self._last(at) >= spacing and self._next(at) - at >= spacing

    def is_due(self, at: float, following: float) -> bool:
        """Return whether a beat now would start or continue a run.

        Args:
            at: time of an accent [s].
            following: time of the next accent [s], or infinity.
        """
        silence, tempo = at - self._last(at), self._tempo
        ahead = bisect_left(self._others, at + LOOK_AHEAD_TIME) - self._first
        elapsed = self._seconds + at - self._since
        due = INITIAL_DUE_STROKES + tempo.rate * elapsed / 60.0 - self._strokes - ahead - len(self.beats)
        if silence <= RUN_SPACING:
            return due > -MAX_SURPLUS_STROKES and self._length(at) < tempo.run_length
        upcoming = min(self._next(at), following)
        if upcoming == float("inf") and due > -MAX_SURPLUS_STROKES:
            upcoming = at + TEXT_END_FRACTION * 60.0 / tempo.rate
        return due >= RUN_START_STROKES or tempo.longest_silence < upcoming - self._last(at) < float("inf")

    def _last(self, at: float) -> float:
        """Return the time of the last stroke before a time [s]."""
        place = bisect_left(self._others, at)
        last = self._others[place - 1] if place else self._since
        return max(last, self.beats[-1]) if self.beats else last

    def _next(self, at: float) -> float:
        """Return the time [s] of the next gesture except beats, or infinity."""
        place = bisect_left(self._others, at)
        return self._others[place] if place < len(self._others) else float("inf")

    def _length(self, at: float) -> int:
        """Return the number of strokes of the run before a time."""
        place, beat, length = bisect_left(self._others, at), len(self.beats), 0
        while length < self._tempo.run_length:
            last = max(self._others[place - 1] if place else -1e3, self.beats[beat - 1] if beat else -1e3)
            if at - last > RUN_SPACING:
                break
            place, beat = (place, beat - 1) if beat and self.beats[beat - 1] == last else (place - 1, beat)
            at, length = last, length + 1
        return length
