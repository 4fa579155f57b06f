"""The face in time: what is expressed, said and done by habit, as action units; the stronger wins for each.

A pure function of the times that are asked for, on the clock of the block: the controller asks once for all ticks.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from kinesic.bml.block import Face, Speech, Timeline
from kinesic.body.action_units import unknown_unit
from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import NO_FACE
from kinesic.body.utterance import Utterance
from kinesic.expressivity.face.expressions import BRIDGED, Envelope, Expression, find_expression
from kinesic.expressivity.face.eyes import (
    STRAIGHT_AHEAD,
    Eyes,
    blink_times,
    blinking,
    flitting,
    gaze_units,
    looking,
    meeting,
)
from kinesic.expressivity.face.visemes import SEAL, visemes
from kinesic.expressivity.keyframes import BodyMove, Outcome
from kinesic.expressivity.lexicon.names import shorten_name
from kinesic.expressivity.style.style import Expressivity, Style

LEAST_INTENSITY = 1e-3  # intensity below which an action unit is not told

SPEAKING = 0.3  # intensity at which speech has the mouth for itself
PRESSED = (SEAL, "23", "28")  # action units that would keep it closed
BEFORE = 0.15  # [s] a speech, when a blink begins
UNMOVED = Eyes()
HANDS_ALONE: Mapping[str, BodyMove] = MappingProxyType({})

Channels = Mapping[str, Floats]  # key of Command.face -> (m,) 0..1


def face_track(
    timeline: Timeline,
    utterances: Mapping[str, Utterance],
    times: Floats,
    *,
    styles: Mapping[str, Style],
    eyes: Eyes = UNMOVED,
    bodies: Mapping[str, BodyMove] = HANDS_ALONE,
) -> Channels:
    """Computes what the face shows during a block.

    Expressions follow their sync points; one that stays gives way to the next that stays. Those that go along with a
    gesture follow its. Speech moves the mouth. Eyes look where the gaze goes, else ahead; they are there before the
    head, turn against it while it moves, flit about and blink.

    Args:
        timeline: behaviours with times.
        utterances: id of a speech -> how it is said.
        times: (m,) [s] block time, increasing.
        styles: behaviour id -> style, in whose manner of the face an expression is shown.
        eyes: what moves them, at the same times.
        bodies: id of a gesture -> what the body does beside it.

    Returns:
        Action units that are ever shown.
    """
    speeches = [
        (timed.times["start"], utterances[timed.behaviour.id])
        for timed in timeline.timed
        if isinstance(timed.behaviour.action, Speech) and timed.behaviour.id in utterances
    ]
    spoken = strongest(visemes(said.phonemes, times, start=start) for start, said in speeches)
    expressed = _open_lips(strongest(_expressions(timeline, times, styles, bodies)), spoken)
    found = strongest((expressed, spoken, strongest(_eyes(times, eyes, [start - BEFORE for start, _ in speeches]))))
    shares = {channel: sealed(np.clip(values, 0.0, 1.0)) for channel, values in found.items()}
    return {channel: values for channel, values in shares.items() if values.max(initial=0.0) >= LEAST_INTENSITY}


def strongest(parts: Iterable[Channels]) -> Channels:
    """Joins several parts: of each action unit the greatest intensity counts at each time."""
    found: dict[str, Floats] = {}
    for part in parts:
        for channel, values in part.items():
            found[channel] = np.maximum(found[channel], values) if channel in found else values
    return found


def face_at_ticks(shown: Channels, ticks: int) -> Iterator[Mapping[str, float]]:
    """Yields what `Command.face` holds at each tick: the action units shown there.

    Args:
        shown: of `face_track`, at as many times.
        ticks: their number.
    """
    rows = {channel: values.tolist() for channel, values in shown.items()}
    for k in range(ticks):
        yield {channel: row[k] for channel, row in rows.items() if row[k] >= LEAST_INTENSITY} or NO_FACE


def outcome(action: Face) -> Outcome:
    """Says what becomes of a face behaviour; of several lexemes those that are known are shown."""
    if action.action_unit is None and not action.lexemes:
        return Outcome("dropped", "it names neither a lexeme nor an action unit")
    shown = find_expression(action)
    if not shown.unknown and not shown.left_out:
        return Outcome("realised")
    if action.action_unit is not None:
        return Outcome("dropped", unknown_unit(str(action.action_unit)))
    if not shown.unknown:
        return Outcome("substituted", f'"{" ".join(shown.left_out)}" is left out')
    why = f"no expression for {', '.join(map(shorten_name, shown.unknown))}"
    return Outcome("dropped" if len(shown.unknown) == len(action.lexemes) else "substituted", why)


def _open_lips(expressed: Channels, spoken: Channels) -> Channels:
    """Lets pressed lips give way where speech opens the mouth."""
    opening = [values for channel, values in spoken.items() if channel != SEAL]
    if not opening:
        return expressed
    shut = 1.0 - np.minimum(np.max(opening, axis=0) / SPEAKING, 1.0)
    return {channel: values * shut if channel in PRESSED else values for channel, values in expressed.items()}


@dataclass(frozen=True)
class _Showing:
    """One expression in time."""

    envelope: Envelope
    shown: Expression
    manner: Expressivity

    def at(self, times: Floats) -> Floats:
        """Shows (m,) shares of it at (m,) times [s]."""
        return self.envelope.at(times, self.manner)


def _expressions(
    timeline: Timeline, times: Floats, styles: Mapping[str, Style], bodies: Mapping[str, BodyMove]
) -> Iterator[Channels]:
    going, staying = (_showings(timeline, styles, shift=shift) for shift in (False, True))
    for each in (*_bridge(going), *_beside_gestures(timeline, styles, bodies)):
        course = each.at(times) * _flutter(each.shown, times - each.envelope.start)
        yield {channel: intensity * course for channel, intensity in each.shown.units.items()}
    left = np.ones(len(times))
    for each in reversed(staying):
        course = each.at(times) * left
        yield {channel: intensity * course for channel, intensity in each.shown.units.items()}
        left = left * (1.0 - each.envelope.at(times))


def _showings(timeline: Timeline, styles: Mapping[str, Style], *, shift: bool) -> list[_Showing]:
    """Lists the expressions that stay, or those that do not, in order of their starts."""
    found = [
        _Showing(Envelope.of(timed.times, stays=shift), find_expression(action), styles[timed.behaviour.id].face)
        for timed in timeline.timed
        if isinstance(action := timed.behaviour.action, Face) and action.shift == shift
    ]
    return sorted(found, key=lambda each: each.envelope.start)


def _beside_gestures(
    timeline: Timeline, styles: Mapping[str, Style], bodies: Mapping[str, BodyMove]
) -> Iterator[_Showing]:
    """Yields what the face shows with gestures: it comes with the preparation, and goes with the hands."""
    for timed in timeline.timed:
        id, times = timed.behaviour.id, timed.times
        for lexeme, amount in bodies[id].face if id in bodies else ():
            envelope = Envelope.of({**times, "attackPeak": times["stroke"]})
            yield _Showing(envelope, find_expression(Face((lexeme,), amount=amount)), styles[id].face)


def _bridge(showings: Sequence[_Showing]) -> list[_Showing]:
    """Lets a flowing expression last until the next has come, where that follows soon."""
    found = list(showings)
    for k, (showing, other) in enumerate(pairwise(showings)):
        gap = other.envelope.start - showing.envelope.end
        if showing.manner.fluidity > 0 and 0.0 <= gap <= BRIDGED * showing.manner.fluidity:
            found[k] = replace(showing, envelope=replace(showing.envelope, end=other.envelope.peak))
    return found


def _flutter(shown: Expression, since: Floats) -> Floats | float:
    """(m,) shares of an expression that comes and goes."""
    return np.sin(np.pi * since / shown.flutter) ** 2 if shown.flutter else 1.0


def _eyes(times: Floats, eyes: Eyes, onsets: Sequence[float]) -> Iterator[Channels]:
    habits, ordered = eyes.habits, [STRAIGHT_AHEAD, *sorted(eyes.looks, key=lambda look: look.start)]
    angles = looking(ordered, times, np.zeros((len(times), 2)) if eyes.head is None else eyes.head)
    if habits is not None and len(times):
        span = (float(times[0]), float(times[-1]))
        if habits.saccades:
            angles = angles + flitting(span, times, habits.seed)
        if habits.blinks:
            yield blinking(blink_times(span, ordered, habits.seed, also=onsets), times)
    yield gaze_units(angles)
    yield meeting(ordered, times)
