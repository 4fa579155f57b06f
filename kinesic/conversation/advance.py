"""Pure transition function of a conversation.

It maps a state and an event to the next state and requests to the robot's body.
"""

from dataclasses import replace
from math import inf

from kinesic.conversation.bearing import mode_bearing
from kinesic.conversation.events import (
    BargeIn,
    ConversationEvent,
    Conversing,
    PeopleSeen,
    RobotSpeech,
    Thinking,
    Transcript,
    TurnPrediction,
    VoiceActivity,
)
from kinesic.conversation.gaze import begin_gaze, continue_gaze, next_gaze_time, request_look
from kinesic.conversation.nods import consider_nod, next_nod_time
from kinesic.conversation.people import Company, choose_focus, expire, observe
from kinesic.conversation.settings import MOVEMENT_SETTINGS
from kinesic.conversation.state import ConversationState, OwnSpeech, PersonVoice
from kinesic.conversation.turn_words import NO_TURN_WORDS, TurnWords
from kinesic.conversation.turns import interrupted, next_mode, next_transition
from kinesic.conversation.wants import Filler, ModeNotice, Want, Yield

ROUNDING_TOLERANCE = 1e-6  # [s] delay added to a next time, so that rounding never makes it too early
TURN_GAP = 2.0  # [s] silence of a person after which a voice begins a new turn
CLAUSE_MARKS = (",", ";", ":", ".", "!", "?", "、", "。")  # punctuation at which a listener may nod


def advance_conversation(
    state: ConversationState, event: ConversationEvent | None, now: float, *, words: TurnWords = NO_TURN_WORDS
) -> tuple[ConversationState, tuple[Want, ...]]:
    """Advance a conversation to a time, with or without an event.

    Args:
        state: state at an earlier time.
        event: event that arrives now; None: only time has passed.
        now: current time [s].
        words: words of the language that stop speech, agree, or announce more words.

    Returns:
        The new state, and the changes of the robot's body that it requests.
    """
    before = state
    if not state.on and not isinstance(event, Conversing):
        return state, ()
    if event is not None:
        state = _take(state, event, now)
    if not state.on:
        return _end(before, state, now)
    company = choose_focus(expire(state.company, now), state.roles, now, eyes=state.eyes)
    lonely_since = now if before.partner is not None and company.focus is None else state.lonely_since
    state = replace(state, company=company, lonely_since=lonely_since)
    wants: list[Want] = []
    if isinstance(event, BargeIn) and state.speech.active:
        state = interrupted(state, now)
        wants.append(Yield(f"a person takes the turn ({event.cause})"))
    else:
        state, stop = next_mode(state, now, words)
        wants += [stop] if stop is not None else []
    if (state.mode, state.company.focus) != (before.mode, before.company.focus):
        partner = state.partner
        wants.append(ModeNotice(state.mode, None if partner is None else partner.id))
    if state.mode != before.mode:
        state = begin_gaze(state, now)
        wants += mode_bearing(state, before.mode)
    state = continue_gaze(state, now)
    state, look = request_look(state, now)
    state, nod = consider_nod(state, now)
    state, filler = _fill(state, now)
    wants += [want for want in (look, nod, filler) if want is not None]
    return state, tuple(wants)


def next_time(state: ConversationState, now: float, *, words: TurnWords = NO_TURN_WORDS) -> float:
    """Return the earliest time [s] of a state change without further events.

    `advance_conversation` must be called then. Infinity if there is none.
    """
    if not state.on:
        return inf
    filler = inf
    if state.mode == "thinking" and state.fillers < len(MOVEMENT_SETTINGS.fillers):
        filler = state.since + MOVEMENT_SETTINGS.fillers[state.fillers]
    times = (next_transition(state, now, words), next_gaze_time(state, now), next_nod_time(state, now), filler)
    return min((time for time in times if time > now), default=inf) + ROUNDING_TOLERANCE


def _take(state: ConversationState, event: ConversationEvent, now: float) -> ConversationState:
    """Apply an event to the state without changing its mode."""
    match event:
        case Conversing(on, amount):
            if on and state.on:
                return replace(state, amount=amount)
            fresh = ConversationState(eyes=state.eyes, seed=state.seed, draws=state.draws)
            return replace(fresh, on=on, amount=amount, mode=state.mode, since=now, lonely_since=now)
        case PeopleSeen():
            return replace(state, company=observe(state.company, event, now, eyes=state.eyes))
        case VoiceActivity(active, who, age):
            return replace(state, voice=_hear(state.voice, active, who, now - age))
        case Transcript(text):
            clauses = state.voice.clauses + (text.rstrip().endswith(CLAUSE_MARKS) and text != state.voice.text)
            return replace(
                state, voice=replace(state.voice, text=text, clauses=clauses, who=event.who or state.voice.who)
            )
        case TurnPrediction(yours):
            return replace(state, voice=replace(state.voice, predicted=yours))
        case Thinking(on):
            return replace(state, thinks=on, listened=state.listened and not on)
        case RobotSpeech(active, ends_in, filler) if not filler:
            ends = inf if ends_in is None else now + ends_in
            began = state.speech.began if state.speech.active else now
            if not active:
                return replace(state, speech=replace(state.speech, active=False))
            return replace(state, speech=OwnSpeech(active=True, began=began, ends=ends))
    return state


def _hear(voice: PersonVoice, active: bool, who: str | None, time: float) -> PersonVoice:
    """Return a person's voice after it starts or ends.

    A detector reports an end later than a start. After a short pause, the report of the end therefore arrives after
    that of the next start, and is ignored.
    """
    if active:
        voice = replace(voice, resumed=max(time, voice.resumed))
    if active == voice.active or (not active and time < voice.resumed):
        return replace(voice, who=who or voice.who)
    if not active:
        return replace(voice, active=False, ended=time)
    if time - voice.ended > TURN_GAP or (who is not None and who != voice.who):
        return PersonVoice(active=True, who=who, began=time, resumed=time)
    return replace(voice, active=True, who=who or voice.who, began=time, predicted=None)


def _end(before: ConversationState, state: ConversationState, now: float) -> tuple[ConversationState, tuple[Want, ...]]:
    """Return the state after a conversation's end, with a client notice."""
    if before.mode == "off":
        return state, ()
    ended = replace(state, mode="off", since=now, company=Company())
    return ended, (ModeNotice("off"),)


def _fill(state: ConversationState, now: float) -> tuple[ConversationState, Filler | None]:
    """Return the new state, and a filler utterance if one is due."""
    if state.mode != "thinking":
        return (state if state.fillers == 0 else replace(state, fillers=0)), None
    if state.fillers >= len(MOVEMENT_SETTINGS.fillers) or now < state.since + MOVEMENT_SETTINGS.fillers[state.fillers]:
        return state, None
    number = state.fillers + 1
    return replace(state, fillers=number), Filler(number, f"thinks for {now - state.since:.1f} s")
