"""Times of changes, random numbers and directions of a conversation, compared with their definitions."""

from dataclasses import replace
from math import atan, degrees, inf, sqrt

import numpy as np
import pytest

from kinesic.conversation import gaze, turns
from kinesic.conversation.advance import advance_conversation
from kinesic.conversation.events import Conversing
from kinesic.conversation.nods import consider_nod, next_nod_time
from kinesic.conversation.people import MAX_ABSENCE, Company, TrackedPerson, direction_change, expire
from kinesic.conversation.settings import MOVEMENT_SETTINGS, TURN_TIMES, Rhythm
from kinesic.conversation.state import ConversationState, OwnSpeech, PersonVoice
from kinesic.conversation.turn_words import turn_words

WORDS = turn_words("en")
LISTENING = ConversationState(
    on=True, mode="listening", since=9.0, listened=True, lonely_since=4.0, voice=PersonVoice(began=5.0, ended=10.0)
)


def test_tracked_person_is_dropped_exactly_at_the_maximum_absence_after_the_last_report():
    people = Company((TrackedPerson("a", "a", (1.0, 0.0, 1.5), False, 2.0),))
    assert expire(people, 2.0 + MAX_ABSENCE - 1e-6) is people
    assert expire(people, 2.0 + MAX_ABSENCE).tracked == ()


def test_gaze_direction_change_is_the_larger_one_of_azimuth_and_elevation_change():
    eyes = (1.0, 2.0, 1.5)
    ahead, up, left = (2.0, 3.0, 1.5), (2.0, 3.0, 2.5), (0.0, 3.0, 1.5)
    assert direction_change(ahead, up, eyes) == pytest.approx(degrees(atan(1 / sqrt(2))))
    assert direction_change(ahead, left, eyes) == pytest.approx(90.0)
    high, higher = (2.0, 2.0, 2.5), (2.0, 2.0, 1.5 + sqrt(3))
    assert direction_change(high, higher, eyes) == direction_change(higher, high, eyes) == pytest.approx(15.0)
    assert direction_change((0.0, 2.1, 1.5), (0.0, 1.9, 1.5), eyes) == pytest.approx(2 * degrees(atan(0.1)))


def test_state_of_a_conversation_that_has_not_begun_changes_at_no_time():
    state = ConversationState()
    assert state.eyes == (0.0, 0.0, 1.5)
    assert turns.next_transition(state, 3.0, WORDS) == inf


@pytest.mark.parametrize(
    ("change", "now", "expected"),
    [
        ({}, 10.0, 10.0 + TURN_TIMES.silence),
        ({}, 10.0 + TURN_TIMES.silence, 10.0 + TURN_TIMES.silence + TURN_TIMES.end_to_thinking),
        ({"voice": PersonVoice(active=True, began=9.9)}, 9.95, 9.9 + TURN_TIMES.voice_to_listening),
        ({"mode": "interrupted", "since": 9.9, "listened": False}, 9.95, 9.9 + TURN_TIMES.interrupted),
        ({"mode": "thinking", "since": 9.0, "listened": False}, 10.0, 9.0 + TURN_TIMES.longest_unasked_thinking),
        ({"mode": "attending", "listened": False}, 10.0, 10.0 + TURN_TIMES.absence_to_idle),
        ({"mode": "attending", "listened": False, "lonely_since": 12.0}, 12.5, 12.0 + TURN_TIMES.absence_to_idle),
        (
            {"mode": "attending", "listened": False, "speech": OwnSpeech(began=11.0)},
            12.5,
            11.0 + TURN_TIMES.absence_to_idle,
        ),
    ],
)
def test_next_transition_time_of_a_conversation_is_the_first_at_which_its_mode_may_change(change, now, expected):
    assert turns.next_transition(replace(LISTENING, **change), now, WORDS) == pytest.approx(expected)


def test_robot_keeps_thinking_without_a_time_limit_while_a_client_reports_that_it_thinks():
    asked = replace(LISTENING, mode="thinking", since=9.0, listened=False, thinks=True)
    limit = 9.0 + TURN_TIMES.longest_unasked_thinking
    assert turns.next_transition(asked, 10.0, WORDS) != pytest.approx(limit)
    assert turns.next_mode(asked, limit + 1.0, WORDS)[0].mode == "thinking"
    assert turns.next_mode(replace(asked, thinks=False), limit + 1.0, WORDS)[0].mode != "thinking"


def test_interrupted_robot_stops_its_speech_and_the_turn_belongs_to_the_person():
    speaking = replace(LISTENING, mode="speaking", listened=False, speech=OwnSpeech(active=True, began=8.0))
    state = turns.interrupted(speaking, 11.0)
    assert (state.mode, state.since, state.speech.active, state.listened) == ("interrupted", 11.0, False, True)
    assert turns.interrupted(replace(state, since=10.5), 11.0).since == 10.5


def test_random_numbers_of_a_conversation_are_uniform_and_repeatable_and_differ_between_seeds():
    def numbers(seed: int) -> list[float]:
        state, drawn = ConversationState(seed=seed), []
        for _ in range(1500):
            number, state = state.draw()
            drawn.append(number)
        return drawn

    drawn = numbers(0)
    assert drawn == numbers(0)
    assert not set(drawn) & set(numbers(1))
    assert all(0.0 <= number < 1.0 for number in drawn)
    for k in range(10):
        assert 110 < sum(k / 10 <= number < (k + 1) / 10 for number in drawn) < 190
    values = [ConversationState(draws=k).vary((2.0, 0.5))[0] for k in range(500)]
    assert 1.5 <= min(values) < 1.52
    assert 2.48 < max(values) < 2.5


def test_averted_gazes_go_sideways_down_and_up_with_the_frequencies_of_their_gaze_rhythm():
    rhythm = Rhythm((1.0, 0.2), (3.0, 0.5), (0.1, 0.2, 0.7), 0.4, angle=20.0)
    angle = rhythm.angle
    spells = [gaze._avert(ConversationState(draws=3 * k), rhythm, 7.0).gaze for k in range(800)]
    assert all(spell.averted and spell.until == 7.0 for spell in spells)
    kinds = {(angle, 0.0): 0.1, (0.3 * angle, -angle): 0.2, (0.6 * angle, angle): 0.7}
    for (side, up), share in kinds.items():
        for sign in (1.0, -1.0):
            count = sum(spell.away == pytest.approx((sign * side, up)) for spell in spells)
            assert count / len(spells) == pytest.approx(share / 2, abs=0.045)
    assert {spell.head_fraction for spell in spells} == {0.0, 0.6}
    assert sum(spell.head_fraction > 0 for spell in spells) / len(spells) == pytest.approx(0.4, abs=0.06)


def test_listening_robot_nods_only_after_a_pause_and_within_the_limits_of_interval_and_number():
    due = 10.0 + MOVEMENT_SETTINGS.pause_before_nod
    assert next_nod_time(LISTENING, 10.0) == pytest.approx(due)
    for other in (
        replace(LISTENING, mode="thinking"),
        replace(LISTENING, nod_considered=10.0),
        replace(LISTENING, voice=PersonVoice(active=True, began=5.0)),
    ):
        assert next_nod_time(other, 10.0) == inf
    assert next_nod_time(LISTENING, due) == inf
    considered = [consider_nod(replace(LISTENING, draws=k), due) for k in range(300)]
    assert all(state.nod_considered == 10.0 for state, _ in considered)
    nods = [nod for _, nod in considered if nod is not None]
    assert len(nods) / 300 == pytest.approx(MOVEMENT_SETTINGS.nod_probability, abs=0.1)
    low, high = MOVEMENT_SETTINGS.nod
    assert all(low <= nod.angle <= high for nod in nods)
    nodding = next(k for k, (_, nod) in enumerate(considered) if nod is not None)
    for times, is_nodded in (
        ((due - MOVEMENT_SETTINGS.nod_interval,), True),
        ((due - 0.99 * MOVEMENT_SETTINGS.nod_interval,), False),
        ((due - 50.0,) * int(MOVEMENT_SETTINGS.nods_per_minute), False),
        ((due - 61.0,) * int(MOVEMENT_SETTINGS.nods_per_minute), True),
    ):
        _, nod = consider_nod(replace(LISTENING, draws=nodding, nods=times), due)
        assert (nod is not None) == is_nodded, times


def test_amount_of_a_running_conversation_changes_without_a_restart():
    state, wants = advance_conversation(LISTENING, Conversing(on=True, amount=0.25), 10.1)
    assert (state.on, state.amount, state.mode, state.since) == (True, 0.25, "listening", 9.0)
    assert state.voice == LISTENING.voice
    assert not [want for want in wants if type(want).__name__ == "ModeNotice"]


@pytest.mark.parametrize(("now", "begins"), [(11.999, False), (12.0, True)])
def test_next_look_of_a_conversation_begins_exactly_at_the_end_of_the_last_one(now, begins):
    away = gaze.GazeSpell(averted=True, away=(10.0, 0.0), until=12.0)
    listening = replace(LISTENING, voice=PersonVoice(active=True, began=5.0), gaze=away)
    found = gaze.continue_gaze(listening, now)
    assert (found.gaze != away) == begins
    assert found.gaze.averted == (not begins)


def test_filler_count_is_reset_when_the_robot_stops_thinking():
    thought = replace(LISTENING, mode="speaking", fillers=2, speech=OwnSpeech(active=True, began=9.0, ends=20.0))
    assert advance_conversation(thought, None, 10.1)[0].fillers == 0


@pytest.mark.parametrize(("seed", "count"), [(0, 0), (0, 1), (7, 3), (123_456, 99)])
def test_random_numbers_of_a_conversation_are_mixed_as_in_splitmix64(seed, count):
    mixed = np.array([seed + 1], np.uint64) * np.uint64(0x9E3779B97F4A7C15) * np.uint64(count + 1) + np.uint64(count)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        mixed = (mixed ^ (mixed >> np.uint64(shift))) * np.uint64(factor)
    mixed ^= mixed >> np.uint64(31)
    number, after = ConversationState(seed=seed, draws=count).draw()
    assert number == (int(mixed[0]) >> 11) / 2**53
    assert after.draws == count + 1
