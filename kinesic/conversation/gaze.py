"""Alternation of looks at people and looks away."""

from dataclasses import replace
from math import dist, inf

from kinesic.conversation.people import direction_change, next_check
from kinesic.conversation.settings import GAZE_RHYTHMS, MOVEMENT_SETTINGS, Rhythm
from kinesic.conversation.state import ConversationState, GazeSpell
from kinesic.conversation.wants import STRAIGHT_DIRECTION, Direction, Look

AVERTED_HEAD_FRACTION = 0.6  # fraction of a look away that the head performs, if it takes part
SHORTEST_LAST_LOOK = 0.6  # [s] shortest duration of the look that ends a speech
UNLIMITED_LOOK = GazeSpell()  # gaze at the person without a time limit


def begin_gaze(state: ConversationState, now: float) -> ConversationState:
    """Start the mode's first look, at or away from the person."""
    rhythm = GAZE_RHYTHMS.get(state.mode)
    if rhythm is None:
        return replace(state, gaze=UNLIMITED_LOOK)
    if state.mode == "speaking":
        return _avert(state, rhythm, now + MOVEMENT_SETTINGS.first_aversion)
    if state.mode == "thinking":
        duration, state = state.vary(rhythm.away)
        return _avert(state, rhythm, now + duration)
    return _look(state, rhythm, now)


def continue_gaze(state: ConversationState, now: float) -> ConversationState:
    """Start the next look, at or away from the person, if due."""
    if _ends_soon(state, now):
        return replace(state, gaze=UNLIMITED_LOOK)
    rhythm = GAZE_RHYTHMS.get(state.mode)
    if rhythm is None or now < state.gaze.until:
        return state
    if state.gaze.averted:
        return _look(state, rhythm, now)
    duration, state = state.vary(rhythm.away)
    return _avert(state, rhythm, now + duration)


def request_look(state: ConversationState, now: float) -> tuple[ConversationState, Look | None]:
    """Return the new state, and a gaze request if one is due.

    MovementSettings within a dead zone are not followed, and corrections are limited in rate.
    """
    target = None if state.mode == "idle" else state.company.target(now)
    place = None if target is None else target.place
    away = tuple(state.amount * angle for angle in state.gaze.away) if state.gaze.averted else STRAIGHT_DIRECTION
    look = Look(place, (away[0], away[1]), state.gaze.head_fraction, _reason(state))
    before = state.look
    if before is not None and (before.place is None) == (place is None) and before.away == look.away:
        if before.place is None or place is None:
            return state, None
        change = direction_change(place, before.place, state.eyes)
        if change < MOVEMENT_SETTINGS.dead_zone or now < state.look_time + MOVEMENT_SETTINGS.shortest_look_interval:
            return state, None
    met_since = state.met_since if before is not None and before.away == look.away == STRAIGHT_DIRECTION else now
    return replace(state, look=look, look_time=now, met_since=met_since), look


def next_gaze_time(state: ConversationState, now: float) -> float:
    """Return the earliest time [s] of a gaze change without further events."""
    times = [state.gaze.until, next_check(state.company, now), _last_look_time(state)]
    if state.look is not None and state.look.place is not None:
        target = state.company.target(now)
        if target is not None and dist(target.place, state.look.place) > 0.0:
            times.append(state.look_time + MOVEMENT_SETTINGS.shortest_look_interval)
    return min((time for time in times if time > now), default=inf)


def _ends_soon(state: ConversationState, now: float) -> bool:
    return state.mode == "speaking" and _last_look_time(state) <= now


def _last_look_time(state: ConversationState) -> float:
    """Return the start time [s] of the look that ends a speech.

    Infinity without an expected end.
    """
    begin, end = state.speech.began, state.speech.ends
    if not state.speech.active or end == inf:
        return inf
    return end - min(
        MOVEMENT_SETTINGS.last_look, SHORTEST_LAST_LOOK + MOVEMENT_SETTINGS.last_look_fraction * (end - begin)
    )


def _look(state: ConversationState, rhythm: Rhythm, now: float) -> ConversationState:
    """Start a look at the person, limited to `longest_look`."""
    duration, state = state.vary(rhythm.look)
    is_met = state.look is not None and state.look.away == STRAIGHT_DIRECTION
    latest = (state.met_since if is_met else now) + MOVEMENT_SETTINGS.longest_look
    return replace(state, gaze=replace(UNLIMITED_LOOK, until=min(now + duration, max(latest, now))))


def _avert(state: ConversationState, rhythm: Rhythm, until: float) -> ConversationState:
    """Start a look away in a random direction."""
    number, state = state.draw()
    side, state = state.draw()
    head, state = state.draw()
    angle, sign = rhythm.angle, 1.0 if side < 0.5 else -1.0
    to_side, down, _ = rhythm.directions
    away: Direction = (sign * angle, 0.0)
    if to_side <= number < to_side + down:
        away = (0.3 * sign * angle, -angle)
    elif number >= to_side + down:
        away = (0.6 * sign * angle, angle)
    fraction = AVERTED_HEAD_FRACTION if head < rhythm.head_probability else 0.0
    return replace(state, gaze=GazeSpell(averted=True, away=away, head_fraction=fraction, until=until))


def _reason(state: ConversationState) -> str:
    """Return the reason of a look, for logs and clients."""
    if state.gaze.averted:
        return f"looks away while {state.mode}"
    return f"{state.mode}: looks at {state.company.focus}" if state.company.focus else state.mode
