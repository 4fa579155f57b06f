"""Looks of a conversation: their ends, corrections and limits."""

from dataclasses import replace
from math import cos, inf, radians, sin

import pytest

from kinesic.conversation.gaze import UNLIMITED_LOOK, GazeSpell, continue_gaze, next_gaze_time, request_look
from kinesic.conversation.people import Company, TrackedPerson
from kinesic.conversation.state import ConversationState, OwnSpeech, PersonVoice
from kinesic.conversation.wants import Look


def at(angle: float) -> tuple[float, float, float]:
    return (cos(radians(angle)), sin(radians(angle)), 1.5)


def facing(angle: float, *, seen: float = 9.9) -> Company:
    return Company((TrackedPerson("a", "a", at(angle), True, seen),), focus="a")


LISTENING = ConversationState(
    on=True,
    mode="listening",
    voice=PersonVoice(active=True, began=5.0),
    company=facing(0),
    look=Look(at(0), (0.0, 0.0), 0.0, "looks"),
    look_time=9.0,
    met_since=5.0,
)


@pytest.mark.parametrize(("ends", "last_look"), [(10.0, 7.7), (4.0, 2.4), (6.8, 4.5)])
def test_look_that_ends_a_speech_lasts_a_quarter_of_it_and_600_ms_but_at_most_2300_ms(ends, last_look):
    away = GazeSpell(averted=True, away=(14.0, 0.0), until=99.0)
    speaking = replace(LISTENING, mode="speaking", gaze=away, speech=OwnSpeech(active=True, began=0.0, ends=ends))
    assert continue_gaze(speaking, last_look - 0.01).gaze == away
    assert continue_gaze(speaking, last_look + 0.01).gaze == UNLIMITED_LOOK
    assert next_gaze_time(replace(speaking, company=Company()), 1.0) == pytest.approx(last_look)
    unknown = replace(speaking, speech=OwnSpeech(active=True, began=0.0, ends=inf))
    assert continue_gaze(unknown, 50.0).gaze == away


@pytest.mark.parametrize(("now", "until"), [(10.0, 10.5), (12.0, 12.0)])
def test_look_at_a_person_lasts_at_most_5500_ms(now, until):
    away = GazeSpell(averted=True, away=(14.0, 0.0), until=now)
    found = continue_gaze(replace(LISTENING, gaze=away), now).gaze
    assert (found.averted, found.until) == (False, pytest.approx(until))
    first = continue_gaze(replace(LISTENING, gaze=away, look=None), now).gaze
    assert now + 2.0 <= first.until <= now + 3.6


@pytest.mark.parametrize(
    ("angle", "now", "is_corrected"), [(2.9, 9.5, False), (3.1, 9.5, True), (3.1, 9.24, False), (3.1, 9.26, True)]
)
def test_gaze_follows_a_person_who_moves_by_three_degrees_at_most_four_times_a_second(angle, now, is_corrected):
    state, look = request_look(replace(LISTENING, company=facing(angle)), now)
    assert (look is not None) == is_corrected
    if look is not None:
        assert (look.place, state.look, state.look_time, state.met_since) == (at(angle), look, now, 5.0)


def test_gaze_is_checked_again_when_a_moved_person_may_be_followed():
    still = replace(LISTENING, company=facing(0, seen=9.1))
    moved = replace(LISTENING, company=facing(1, seen=9.1))
    assert next_gaze_time(still, 9.1) == pytest.approx(10.1)
    assert next_gaze_time(moved, 9.1) == pytest.approx(9.25)


def test_look_back_at_a_person_restarts_the_time_of_the_look():
    away = replace(LISTENING, look=Look(at(0), (14.0, 0.0), 0.0, "looks away"))
    state, look = request_look(away, 9.5)
    assert look is not None
    assert (look.away, state.met_since) == ((0.0, 0.0), 9.5)


def test_looks_away_are_scaled_by_the_amount_of_movement():
    averted = replace(LISTENING, amount=0.5, gaze=GazeSpell(averted=True, away=(14.0, -6.0), head_fraction=0.6))
    _, look = request_look(averted, 9.5)
    assert look is not None
    assert (look.away, look.head_fraction, look.reason) == ((7.0, -3.0), 0.6, "looks away while listening")
