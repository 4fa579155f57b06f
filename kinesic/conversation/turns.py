"""Transitions between the states of a conversation."""

from dataclasses import replace
from math import inf

from kinesic.conversation.settings import TURN_TIMES
from kinesic.conversation.state import ConversationState
from kinesic.conversation.turn_words import TurnWords
from kinesic.conversation.wants import Mode, Yield


def turn_end(state: ConversationState, words: TurnWords) -> float:
    """Return a turn's end time [s] if the voice stays silent.

    Infinity while the person speaks, or without a turn.
    """
    voice = state.voice
    if voice.active or not state.listened:
        return inf
    if voice.predicted is not None and voice.predicted > TURN_TIMES.prediction_threshold:
        return voice.ended + TURN_TIMES.silence_if_predicted
    is_unlikely = voice.predicted is not None and voice.predicted < TURN_TIMES.doubt_threshold
    if is_unlikely or words.is_unfinished(voice.text):
        return voice.ended + TURN_TIMES.silence_if_unfinished
    return voice.ended + TURN_TIMES.silence


def yield_time(state: ConversationState, words: TurnWords) -> float:
    """Return the time [s] when a person's voice stops the robot's speech.

    Infinity without such a voice. Words of agreement do not count.
    """
    voice = state.voice
    if not state.speech.active or voice.ended < state.speech.began > voice.began:
        return inf
    text = words.without_agreement(voice.text)
    if words.has_stop_word(voice.text) or len(text) >= TURN_TIMES.words_to_yield:
        return -inf
    if voice.active and not (voice.text and not text):
        return max(voice.began, state.speech.began) + TURN_TIMES.voice_to_yield
    return inf


def next_mode(state: ConversationState, now: float, words: TurnWords) -> tuple[ConversationState, Yield | None]:
    """Return the state with its current mode, and a request to yield.

    The request is None unless a person takes the turn from the speaking robot.
    """
    if not state.on:
        return _enter(state, "off", now), None
    if yield_time(state, words) <= now:
        reason = "stop word" if words.has_stop_word(state.voice.text) else "a person speaks"
        return interrupted(state, now), Yield(reason)
    if state.speech.active:
        return _enter(replace(state, thinks=False), "speaking", now), None
    if state.mode == "interrupted" and now < state.since + TURN_TIMES.interrupted:
        return state, None
    goes_on = state.listened or state.voice.duration(now) >= TURN_TIMES.voice_to_listening
    if state.voice.active and goes_on:
        return _enter(replace(state, listened=True, thinks=False), "listening", now), None
    end = turn_end(state, words)
    if now < end < inf:
        return _enter(state, "listening", now), None
    if state.thinks:
        return _enter(replace(state, listened=False), "thinking", now), None
    if end <= now:
        if now < end + TURN_TIMES.end_to_thinking:
            return state, None
        answered = replace(state, listened=False, addressee=state.voice.who or state.addressee)
        return _enter(answered, "thinking", now), None
    if state.mode == "thinking" and now < state.since + TURN_TIMES.longest_unasked_thinking:
        return state, None
    return _enter(state, "attending" if _has_company(state, now) else "idle", now), None


def interrupted(state: ConversationState, now: float) -> ConversationState:
    """Return the state after a person has interrupted the robot's speech."""
    silent = replace(state, speech=replace(state.speech, active=False), listened=True)
    return _enter(silent, "interrupted", now)


def next_transition(state: ConversationState, now: float, words: TurnWords) -> float:
    """Return the earliest time [s] of a mode change without further events."""
    if not state.on:
        return inf
    end = turn_end(state, words)
    times = [
        yield_time(state, words),
        state.voice.began + TURN_TIMES.voice_to_listening if state.voice.active else inf,
        end,
        end + TURN_TIMES.end_to_thinking,
        state.since + TURN_TIMES.interrupted if state.mode == "interrupted" else inf,
        state.since + TURN_TIMES.longest_unasked_thinking if state.mode == "thinking" and not state.thinks else inf,
        _idle_time(state),
    ]
    return min((time for time in times if time > now), default=inf)


def _has_company(state: ConversationState, now: float) -> bool:
    return state.partner is not None or now < _idle_time(state)


def _idle_time(state: ConversationState) -> float:
    """Return the time [s] when the robot idles without a person."""
    if state.partner is not None:
        return inf
    last = max(state.lonely_since, state.voice.ended, state.speech.began)
    return last + TURN_TIMES.absence_to_idle


def _enter(state: ConversationState, mode: Mode, now: float) -> ConversationState:
    return state if state.mode == mode else replace(state, mode=mode, since=now)
