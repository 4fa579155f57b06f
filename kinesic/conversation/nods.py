"""Nods of a listener at the pauses and clauses of a speaker."""

from dataclasses import replace
from math import inf

from kinesic.conversation.settings import MOVEMENT_SETTINGS
from kinesic.conversation.state import ConversationState
from kinesic.conversation.wants import Nod

NOD_WINDOW = 60.0  # [s] time span of `nods_per_minute`


def consider_nod(state: ConversationState, now: float) -> tuple[ConversationState, Nod | None]:
    """Return the new state, and a nod if the listener nods now."""
    voice = state.voice
    if state.mode != "listening" or not _is_pause(state, now):
        return state, None
    chance, state = state.draw()
    state = replace(state, nod_considered=voice.ended, voice=replace(voice, clauses=0))
    recent = tuple(time for time in state.nods if now - time < NOD_WINDOW)
    is_soon = bool(recent) and now - recent[-1] < MOVEMENT_SETTINGS.nod_interval
    if is_soon or len(recent) >= MOVEMENT_SETTINGS.nods_per_minute or chance >= MOVEMENT_SETTINGS.nod_probability:
        return replace(state, nods=recent), None
    low, high = MOVEMENT_SETTINGS.nod
    size, state = state.draw()
    angle = state.amount * (low + (high - low) * size)
    return replace(state, nods=(*recent, now)), Nod(angle, "the speaker pauses")


def next_nod_time(state: ConversationState, now: float) -> float:
    """Return the earliest time [s] of a nod without further events."""
    voice = state.voice
    if state.mode != "listening" or voice.active or state.nod_considered == voice.ended:
        return inf
    due = voice.ended + MOVEMENT_SETTINGS.pause_before_nod
    return due if due > now else inf


def _is_pause(state: ConversationState, now: float) -> bool:
    """Return whether the speaker has just paused or finished a clause."""
    voice = state.voice
    if voice.active:
        return voice.clauses > 0 and voice.duration(now) >= MOVEMENT_SETTINGS.voice_before_nod
    if state.nod_considered == voice.ended or voice.duration(now) < MOVEMENT_SETTINGS.voice_before_nod:
        return False
    return now >= voice.ended + MOVEMENT_SETTINGS.pause_before_nod
