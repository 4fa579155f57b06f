"""Conversational turns, interruptions, people and nods on both sides of each threshold."""

from dataclasses import replace
from math import cos, exp, inf, radians, sin
from types import SimpleNamespace

import pytest

from kinesic.conversation.events import PeopleSeen, Person
from kinesic.conversation.nods import consider_nod
from kinesic.conversation.people import Company, Roles, TrackedPerson, choose_focus, is_near, is_visible, observe
from kinesic.conversation.state import ConversationState, OwnSpeech, PersonVoice
from kinesic.conversation.turns import next_mode, turn_end, yield_time

EYES = (0.0, 0.0, 1.5)
HEARD = ConversationState(on=True, mode="listening", since=9.0, listened=True, voice=PersonVoice(began=5.0, ended=10.0))
WORDS = SimpleNamespace(  # "yes" agrees, "stop" stops speech, a text that ends with "and" is unfinished
    is_unfinished=lambda text: text.endswith("and"),
    without_agreement=lambda text: [word for word in text.split() if word != "yes"],
    has_stop_word=lambda text: "stop" in text.split(),
)


def voice(**changes) -> PersonVoice:
    return replace(HEARD.voice, **changes)


@pytest.mark.parametrize(
    ("change", "end"),
    [
        ({}, 10.7),
        ({"voice": voice(predicted=0.61)}, 10.2),
        ({"voice": voice(predicted=0.6)}, 10.7),
        ({"voice": voice(predicted=0.4)}, 10.7),
        ({"voice": voice(predicted=0.39)}, 11.2),
        ({"voice": voice(text="I came and")}, 11.2),
        ({"voice": voice(text="I came and", predicted=0.61)}, 10.2),
        ({"voice": voice(active=True)}, inf),
        ({"listened": False}, inf),
    ],
)
def test_silence_that_ends_a_turn_depends_on_its_predicted_end_and_its_last_word(change, end):
    assert turn_end(replace(HEARD, **change), WORDS) == pytest.approx(end)


SPEECH = OwnSpeech(active=True, began=8.0)


@pytest.mark.parametrize(
    ("sound", "speech", "time"),
    [
        (voice(active=True, began=9.0), SPEECH, 9.75),
        (voice(active=True, began=7.0, ended=8.0), SPEECH, 8.75),
        (voice(active=True, began=9.0, text="yes"), SPEECH, inf),
        (voice(active=True, began=9.0, text="yes wait"), SPEECH, 9.75),
        (voice(active=True, began=9.0, text="wait please"), SPEECH, -inf),
        (voice(began=9.0, text="wait"), SPEECH, inf),
        (voice(began=9.0, text="stop"), SPEECH, -inf),
        (voice(began=7.0, ended=7.9, text="stop"), SPEECH, inf),
        (voice(began=7.0, ended=8.0, text="stop"), SPEECH, -inf),
        (voice(active=True, began=9.0, text="stop"), replace(SPEECH, active=False), inf),
    ],
)
def test_voice_stops_the_robots_speech_by_two_words_a_stop_word_or_its_duration(sound, speech, time):
    assert yield_time(replace(HEARD, voice=sound, speech=speech), WORDS) == pytest.approx(time)


@pytest.mark.parametrize(
    ("change", "now", "mode"),
    [
        ({}, 10.69, "listening"),
        ({}, 10.71, "listening"),
        ({}, 10.99, "listening"),
        ({}, 11.01, "thinking"),
        ({"thinks": True}, 10.71, "thinking"),
        ({"mode": "interrupted", "since": 9.0, "listened": False}, 9.79, "interrupted"),
        ({"mode": "interrupted", "since": 9.0, "listened": False}, 9.81, "attending"),
        ({"mode": "thinking", "since": 9.0, "listened": False}, 16.9, "thinking"),
        ({"mode": "thinking", "since": 9.0, "listened": False}, 17.1, "attending"),
        ({"listened": False}, 19.9, "attending"),
        ({"listened": False}, 20.0, "idle"),
        ({"listened": False, "voice": voice(active=True, began=9.0)}, 9.14, "attending"),
        ({"listened": False, "voice": voice(active=True, began=9.0)}, 9.16, "listening"),
        ({"speech": OwnSpeech(active=True, began=11.0)}, 12.0, "speaking"),
        ({"on": False}, 12.0, "off"),
    ],
)
def test_mode_of_a_conversation_changes_at_the_times_of_its_rules(change, now, mode):
    assert next_mode(replace(HEARD, **change), now, WORDS)[0].mode == mode


def test_turn_that_ended_belongs_to_the_person_who_spoke():
    spoken = replace(HEARD, voice=voice(who="b"), addressee="a")
    assert next_mode(spoken, 11.1, WORDS)[0].addressee == "b"
    assert next_mode(replace(HEARD, addressee="a"), 11.1, WORDS)[0].addressee == "a"


def test_reason_for_yielding_is_the_stop_word_or_the_voice():
    for text, reason in (("stop", "stop word"), ("wait please", "a person speaks")):
        speaking = replace(HEARD, speech=SPEECH, voice=voice(active=True, began=9.0, text=text))
        assert next_mode(speaking, 9.1, WORDS)[1].reason == reason


def at(distance: float, angle: float = 0.0) -> tuple[float, float, float]:
    return (distance * cos(radians(angle)), distance * sin(radians(angle)), 1.5)


@pytest.mark.parametrize(
    ("place", "visible", "near"),
    [
        (at(0.39), False, False),
        (at(0.4), True, True),
        (at(3.0), True, True),
        (at(2.99), True, True),
        (at(3.01), True, False),
        (at(1.0, 109.9), True, True),
        (at(1.0, 110.1), False, False),
        (at(1.0, -109.9), True, True),
        (at(1.0, -110.1), False, False),
    ],
)
def test_robot_looks_at_people_within_a_sector_and_attends_to_near_ones(place, visible, near):
    assert (is_visible(place, EYES), is_near(place, EYES)) == (visible, near)


def tracked(key: str, place, looks: bool = False) -> TrackedPerson:
    return TrackedPerson(key, key, place, looks, 5.0)


@pytest.mark.parametrize(
    ("other", "roles", "challenger"),
    [
        (tracked("b", at(0.99, -40), looks=True), Roles(), "b"),
        (tracked("b", at(1.01, -40), looks=True), Roles(), None),
        (tracked("b", at(1.0, -40)), Roles(addressee="b"), "b"),
        (tracked("b", at(1.0, -40)), Roles(speaker="b", addressee="a"), "b"),
        (tracked("b", at(1.0, -40), looks=True), Roles(speaker="a"), None),
        (tracked("b", at(0.41, -40)), Roles(), None),
    ],
)
def test_person_who_leads_by_three_tenths_of_a_score_challenges_the_attended_one(other, roles, challenger):
    people = Company((tracked("a", at(1.0, 40)), other), focus="a", focus_since=0.0)
    found = choose_focus(people, roles, 5.0, eyes=EYES)
    assert (found.focus, found.challenger) == ("a", challenger)
    if challenger is not None:
        assert choose_focus(found, roles, 5.39, eyes=EYES).focus == "a"
        assert choose_focus(found, roles, 5.41, eyes=EYES).focus == challenger


def seen_at(place, *, name="a", time=5.15):
    start = Company((tracked("a", at(1.0)),), focus="a")
    return observe(start, PeopleSeen((Person(name, place, False),), 0.0), time, eyes=EYES)


@pytest.mark.parametrize(("angle", "follows"), [(19.9, True), (20.1, False)])
def test_position_that_jumps_by_more_than_20_degrees_is_not_followed_at_once(angle, follows):
    (person,) = seen_at(at(1.0, angle)).tracked
    moved = 1.0 - exp(-1.0)
    assert person.place[1] == pytest.approx(moved * sin(radians(angle)) if follows else 0.0)
    assert (person.jump is None) == follows


@pytest.mark.parametrize(("shift", "count"), [(0.29, 1), (0.31, 2)])
def test_person_under_another_id_within_30_cm_is_the_same(shift, count):
    assert len(seen_at(at(1.0 + shift), name="b").tracked) == count


@pytest.mark.parametrize(
    ("sound", "now", "may_nod"),
    [
        (voice(), 10.19, False),
        (voice(), 10.21, True),
        (voice(began=9.31), 10.3, False),
        (voice(began=9.29), 10.3, True),
        (voice(active=True, began=9.0, clauses=1), 9.71, True),
        (voice(active=True, began=9.0, clauses=1), 9.69, False),
        (voice(active=True, began=9.0, clauses=0), 9.9, False),
    ],
)
def test_listener_considers_a_nod_after_a_pause_or_a_clause_of_a_long_enough_voice(sound, now, may_nod):
    state, _ = consider_nod(replace(HEARD, voice=sound), now)
    assert (state.draws > HEARD.draws) == may_nod
    assert not may_nod or (state.voice.clauses == 0 and state.nod_considered == sound.ended)
