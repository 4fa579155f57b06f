"""Action unit tracks of expressions, speech and eyes, merged by the maximum.

A pure function of the requested times, on the clock of the block: the controller calls it once for all ticks.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from kinesic.bml.block import Face, Speech, Timeline
from kinesic.body.action_units import describe_unknown_unit
from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import NO_FACE
from kinesic.body.utterance import Utterance
from kinesic.expressivity.face.blinks import blink_times, blink_units
from kinesic.expressivity.face.brows import brow_units
from kinesic.expressivity.face.expressions import MAX_BRIDGED_GAP, Envelope, Expression, find_expression
from kinesic.expressivity.face.eyes import (
    STRAIGHT_AHEAD,
    Eyes,
    averted_gazes,
    eye_angles,
    gaze_units,
    saccade_offsets,
    vergence_units,
)
from kinesic.expressivity.face.visemes import SEAL_UNIT, visemes
from kinesic.expressivity.keyframes import BodyMove, Outcome
from kinesic.expressivity.lexicon.names import shorten_name
from kinesic.expressivity.prosody import NO_PROSODY, Prosody, choose_accents, find_phrase_ends, scale_openings
from kinesic.expressivity.style.style import Expressivity, Style

MIN_INTENSITY = 1e-3  # intensity below which action units are omitted

SPEAKING_INTENSITY = 0.3  # intensity of speech action units from which expressions no longer close the mouth
CLOSING_UNITS = (SEAL_UNIT, "23", "28")  # action units that close the mouth
BLINK_LEAD_TIME = 0.15  # [s] time from the start of a blink to the start of a speech
FROWN_UNITS = ("L4", "R4")  # action units that lower the brows; raised brows yield to them
STILL_EYES = Eyes()  # eyes that look straight ahead, without spontaneous motion
NO_AFFECT: Mapping[str, float] = MappingProxyType({})  # default: no permanent facial expression, empty
NO_BODY_MOVES: Mapping[str, BodyMove] = MappingProxyType({})  # default: no gesture moves the body, empty

Channels = Mapping[str, Floats]  # key of Command.face -> (m,) 0..1


def face_track(
    timeline: Timeline,
    utterances: Mapping[str, Utterance],
    times: Floats,
    *,
    styles: Mapping[str, Style],
    eyes: Eyes = STILL_EYES,
    bodies: Mapping[str, BodyMove] = NO_BODY_MOVES,
    affect: Mapping[str, float] = NO_AFFECT,
    prosody: Prosody = NO_PROSODY,
) -> Channels:
    """Compute the action unit tracks (m,) of a block at given times.

    Expressions follow their sync points; one that stays lasts until the next that stays. Those that accompany a gesture
    follow its sync points. Speech moves the mouth, raises the brows on accents where the document shows no expression,
    and closes the eyes briefly at ends of phrases. Eyes look at the gaze target, otherwise ahead; they arrive before
    the head, counter-rotate while it moves, make saccades and blink.

    Args:
        timeline: behaviours with times.
        utterances: id of a speech -> utterance.
        times: (m,) [s] block time, increasing.
        styles: behaviour id -> style, whose face expressivity applies to its expressions.
        eyes: inputs of the eye motion, at the same times.
        bodies: id of a gesture -> accompanying body motion.
        affect: lexeme of an expression -> amount, shown where the document has no expression.
        prosody: amount of the motion that follows the voice.

    Returns:
        Action units that are visible at some time.
    """
    speeches = [
        (timed.times["start"], utterances[timed.behaviour.id])
        for timed in timeline.timed
        if isinstance(timed.behaviour.action, Speech) and timed.behaviour.id in utterances
    ]
    spoken = merge_tracks(
        visemes(scale_openings(utterance.phonemes, prosody.amount), times, start=start) for start, utterance in speeches
    )
    undirected = _undirected(timeline, times, styles, bodies)
    expressed = _open_lips(
        merge_tracks((*_expressions(timeline, times, styles, bodies), _affect(affect, timeline, times, styles))), spoken
    )
    raised = merge_tracks(_raised_brows(timeline, utterances, times, styles, prosody))
    free = undirected * (1.0 - np.max([expressed.get(unit, 0.0 * times) for unit in FROWN_UNITS], axis=0))
    blinks = [start - BLINK_LEAD_TIME for start, _ in speeches]
    if prosody.amount > 0.0:
        blinks += [start + end for start, utterance in speeches for end in find_phrase_ends(utterance)]
    merged = merge_tracks(
        (
            expressed,
            spoken,
            {channel: values * free for channel, values in raised.items()},
            merge_tracks(_eyes(times, eyes, blinks)),
        )
    )
    clipped = {channel: sealed(np.clip(values, 0.0, 1.0)) for channel, values in merged.items()}
    return {channel: values for channel, values in clipped.items() if values.max(initial=0.0) >= MIN_INTENSITY}


def merge_tracks(parts: Iterable[Channels]) -> Channels:
    """Merge tracks by the maximum intensity of each action unit."""
    merged: dict[str, Floats] = {}
    for part in parts:
        for channel, values in part.items():
            merged[channel] = np.maximum(merged[channel], values) if channel in merged else values
    return merged


def face_at_ticks(shown: Channels, ticks: int) -> Iterator[Mapping[str, float]]:
    """Yield the intensities, 0..1, of visible action units per command.

    Args:
        shown: of `face_track`, at as many times.
        ticks: their number.
    """
    rows = {channel: values.tolist() for channel, values in shown.items()}
    for k in range(ticks):
        yield {channel: row[k] for channel, row in rows.items() if row[k] >= MIN_INTENSITY} or NO_FACE


def face_outcome(action: Face) -> Outcome:
    """Return the outcome of a face behaviour.

    Unknown lexemes are skipped.
    """
    if action.action_unit is None and not action.lexemes:
        return Outcome("dropped", "it names neither a lexeme nor an action unit")
    shown = find_expression(action)
    if not shown.unknown and not shown.left_out:
        return Outcome("realised")
    if action.action_unit is not None:
        return Outcome("dropped", describe_unknown_unit(str(action.action_unit)))
    if not shown.unknown:
        return Outcome("substituted", f'"{" ".join(shown.left_out)}" is left out')
    why = f"no expression for {', '.join(map(shorten_name, shown.unknown))}"
    return Outcome("dropped" if len(shown.unknown) == len(action.lexemes) else "substituted", why)


def _open_lips(expressed: Channels, spoken: Channels) -> Channels:
    """Scale down mouth-closing action units while speech opens the mouth."""
    opening = [values for channel, values in spoken.items() if channel != SEAL_UNIT]
    if not opening:
        return expressed
    shut = 1.0 - np.minimum(np.max(opening, axis=0) / SPEAKING_INTENSITY, 1.0)
    return {channel: values * shut if channel in CLOSING_UNITS else values for channel, values in expressed.items()}


@dataclass(frozen=True)
class _Showing:
    """Facial expression with its time course and expressivity."""

    envelope: Envelope
    shown: Expression
    manner: Expressivity

    def at(self, times: Floats) -> Floats:
        """Return the intensity (m,) of the expression relative to its peak."""
        return self.envelope.at(times, self.manner)


def _expressions(
    timeline: Timeline, times: Floats, styles: Mapping[str, Style], bodies: Mapping[str, BodyMove]
) -> Iterator[Channels]:
    temporary, permanent = (_showings(timeline, styles, shift=shift) for shift in (False, True))
    for showing in (*_bridge_gaps(temporary), *_gesture_expressions(timeline, styles, bodies)):
        modulation = showing.at(times) * _pulsation_factor(showing.shown, times - showing.envelope.start)
        yield {channel: intensity * modulation for channel, intensity in showing.shown.units.items()}
    remaining = np.ones(len(times))
    for showing in reversed(permanent):
        modulation = showing.at(times) * remaining
        yield {channel: intensity * modulation for channel, intensity in showing.shown.units.items()}
        remaining = remaining * (1.0 - showing.envelope.at(times))


def _affect(affect: Mapping[str, float], timeline: Timeline, times: Floats, styles: Mapping[str, Style]) -> Channels:
    """Return a style's permanent expression, suppressed while the document shows an expression."""
    if not affect:
        return {}
    remaining = _undirected(timeline, times, styles, NO_BODY_MOVES)
    shown = [find_expression(Face((lexeme,), amount=amount)) for lexeme, amount in affect.items()]
    return merge_tracks(
        {channel: intensity * remaining for channel, intensity in expression.units.items()} for expression in shown
    )


def _undirected(
    timeline: Timeline, times: Floats, styles: Mapping[str, Style], bodies: Mapping[str, BodyMove]
) -> Floats:
    """Return the factor (m,) on permanent expression and raised brows during expressions.

    Expressions of the document or of gestures suppress raised brows and a style's permanent expression: 1 without any
    expression, 0 at full intensity.
    """
    free = np.ones(len(times))
    own = (showing for shift in (False, True) for showing in _showings(timeline, styles, shift=shift))
    for showing in (*own, *_gesture_expressions(timeline, styles, bodies)):
        free = free * (1.0 - np.clip(showing.envelope.at(times), 0.0, 1.0))
    return free


def _raised_brows(
    timeline: Timeline,
    utterances: Mapping[str, Utterance],
    times: Floats,
    styles: Mapping[str, Style],
    prosody: Prosody,
) -> Iterator[Channels]:
    """Yield, for each speech, the action units of brows raised on accents."""
    if prosody.amount <= 0.0:
        return
    for timed in timeline.timed:
        id, action = timed.behaviour.id, timed.behaviour.action
        if isinstance(action, Speech) and id in utterances:
            accents = choose_accents(id, utterances[id], action.script, prosody.seed)
            start, manner = timed.times["start"], styles[id].face
            yield brow_units(accents, times, start=start, amount=prosody.amount, manner=manner)


def _showings(timeline: Timeline, styles: Mapping[str, Style], *, shift: bool) -> list[_Showing]:
    """Return either the permanent or the temporary expressions, sorted by start."""
    merged = [
        _Showing(Envelope.of(timed.times, stays=shift), find_expression(action), styles[timed.behaviour.id].face)
        for timed in timeline.timed
        if isinstance(action := timed.behaviour.action, Face) and action.shift == shift
    ]
    return sorted(merged, key=lambda showing: showing.envelope.start)


def _gesture_expressions(
    timeline: Timeline, styles: Mapping[str, Style], bodies: Mapping[str, BodyMove]
) -> Iterator[_Showing]:
    """Yield the expressions that accompany gestures.

    They rise with the preparation, and decay with the retraction.
    """
    for timed in timeline.timed:
        id, times = timed.behaviour.id, timed.times
        for lexeme, amount in bodies[id].face if id in bodies else ():
            envelope = Envelope.of({**times, "attackPeak": times["stroke"]})
            yield _Showing(envelope, find_expression(Face((lexeme,), amount=amount)), styles[id].face)


def _bridge_gaps(showings: Sequence[_Showing]) -> list[_Showing]:
    """Extend expressions over short gaps at positive fluidity.

    They are extended if the next one follows soon.
    """
    merged = list(showings)
    for k, (showing, other) in enumerate(pairwise(showings)):
        gap = other.envelope.start - showing.envelope.end
        if showing.manner.fluidity > 0 and 0.0 <= gap <= MAX_BRIDGED_GAP * showing.manner.fluidity:
            merged[k] = replace(showing, envelope=replace(showing.envelope, end=other.envelope.peak))
    return merged


def _pulsation_factor(shown: Expression, since: Floats) -> Floats | float:
    """Return the intensity factor (m,) of an expression that pulsates, 0..1."""
    return np.sin(np.pi * since / shown.flutter) ** 2 if shown.flutter else 1.0


def _eyes(times: Floats, eyes: Eyes, onsets: Sequence[float]) -> Iterator[Channels]:
    habits = eyes.habits
    averted = averted_gazes(times, eyes.gaze, 0 if habits is None else habits.seed)
    ordered = [STRAIGHT_AHEAD, *averted, *sorted(eyes.looks, key=lambda look: look.start)]
    angles = eye_angles(ordered, times, np.zeros((len(times), 2)) if eyes.head is None else eyes.head)
    if habits is not None and len(times):
        span = (float(times[0]), float(times[-1]))
        if habits.saccades:
            angles = angles + saccade_offsets(span, times, habits.seed)
        if habits.blinks:
            yield blink_units(blink_times(span, ordered, habits.seed, also=onsets), times, habits.seed)
    yield gaze_units(angles)
    yield vergence_units(ordered, times)
