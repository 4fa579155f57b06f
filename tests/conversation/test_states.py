"""States of a conversation in virtual time."""

from itertools import pairwise

import numpy as np
import pytest

from kinesic.conversation.advance import advance_conversation, next_time
from kinesic.conversation.events import (
    BargeIn,
    Conversing,
    PeopleSeen,
    Person,
    RobotSpeech,
    Thinking,
    Transcript,
    TurnPrediction,
    VoiceActivity,
)
from kinesic.conversation.settings import MODE_BEARINGS, MOVEMENT_SETTINGS, TURN_TIMES
from kinesic.conversation.state import ConversationState
from kinesic.conversation.turn_words import NO_TURN_WORDS, turn_words
from kinesic.conversation.wants import BodyLean, BriefExpression, Filler, HeldExpression, Look, ModeNotice, Nod, Yield
from tests.conversation.dialogues import ENGLISH, FRONT, converse, present, says

LEFT = (1.0, 1.0, 1.5)


def time_of(record, mode: str) -> float:
    return next(time for time, name in record.modes() if name == mode)


def test_conversation_turn_passes_through_listening_thinking_and_speaking():
    speech = [(9.0, RobotSpeech(active=True, ends_in=4.0)), (13.0, RobotSpeech(active=False))]
    record = converse([*present(15.0), *says(2.0, 6.0), (8.0, Thinking(on=True)), *speech], 15.0)
    assert [mode for _, mode in record.modes()] == ["attending", "listening", "thinking", "speaking", "attending"]
    assert time_of(record, "listening") == pytest.approx(2.0 + TURN_TIMES.voice_to_listening, abs=0.01)
    assert time_of(record, "thinking") == pytest.approx(6.0 + 0.7 + 0.3, abs=0.01)
    assert time_of(record, "speaking") == 9.0


def test_silence_that_ends_a_persons_turn_depends_on_last_words_and_turn_prediction():
    delays = {}
    for name, event in {
        "silence": Transcript("I saw a dog."),
        "conjunction": Transcript("I saw a dog and"),
        "hesitation": Transcript("I saw, um"),
        "prediction": TurnPrediction(0.8),
        "doubt": TurnPrediction(0.4),
        "unlikely": TurnPrediction(0.2),
    }.items():
        record = converse([*present(8.0), *says(2.0, 4.0), (3.9, event)], 8.0)
        delays[name] = time_of(record, "thinking") - 4.0 - TURN_TIMES.end_to_thinking
    expected = {"silence": 0.7, "conjunction": 1.2, "hesitation": 1.2, "prediction": 0.2, "doubt": 0.7, "unlikely": 1.2}
    assert delays == pytest.approx(expected, abs=0.01)


def test_short_pause_within_a_persons_turn_does_not_end_the_turn():
    record = converse([*present(9.0), *says(2.0, 3.0), *says(3.6, 5.0), *says(5.5, 6.5)], 9.0)
    assert [mode for _, mode in record.modes()] == ["attending", "listening", "thinking"]
    assert time_of(record, "thinking") > 6.5


def test_person_who_speaks_over_the_robot_interrupts_it():
    talk = [*present(9.0), (2.0, RobotSpeech(active=True, ends_in=6.0))]
    cases = {
        "long voice": ([(3.0, VoiceActivity(active=True))], 3.0 + TURN_TIMES.voice_to_yield),
        "short voice": (says(3.0, 3.4), None),
        "agreement": ([(3.0, VoiceActivity(active=True)), (3.3, Transcript("uh-huh yeah"))], None),
        "stop word": ([(3.0, VoiceActivity(active=True)), (3.25, Transcript("Stop"))], 3.25),
        "agreement, then stop": ([(3.0, VoiceActivity(active=True)), (3.25, Transcript("okay, wait"))], 3.25),
        "two words": ([(3.0, VoiceActivity(active=True)), (3.3, Transcript("what about"))], 3.3),
        "one word": ([(3.0, VoiceActivity(active=True)), (3.1, Transcript("what"))], 3.0 + TURN_TIMES.voice_to_yield),
        "client": ([(3.1, BargeIn("client"))], 3.1),
    }
    for name, (events, expected) in cases.items():
        record = converse([*talk, *events], 7.9)
        times = [time for time, _ in record.of(Yield)]
        assert times == ([] if expected is None else [pytest.approx(expected, abs=0.01)]), name
        assert (record.mode_at(3.85) == "interrupted") == (expected is not None), name


def test_robot_interrupted_by_a_person_looks_at_the_person_and_then_listens():
    events = [*present(9.0), (2.0, RobotSpeech(active=True, ends_in=6.0)), *says(3.0, 6.0)]
    record = converse(events, 6.0)
    assert [mode for _, mode in record.modes()] == ["attending", "speaking", "interrupted", "listening"]
    assert record.looking_fraction(3.8, 4.5) == 1.0
    brows = [want for _, want in record.of(BriefExpression) if want.reason == "interrupted"]
    assert len(brows) == 1


def test_voice_that_ended_before_the_robot_speaks_does_not_interrupt_its_speech():
    events = [*present(9.0), *says(1.0, 3.0), (3.2, RobotSpeech(active=True, ends_in=3.0))]
    assert converse(events, 7.0).of(Yield) == []


def test_fractions_of_time_the_robot_looks_at_the_person_lie_in_ranges_of_human_conversation():
    fractions = []
    for seed in range(24):
        duration = 7.0 + seed % 8
        speech = [(20.0, RobotSpeech(active=True, ends_in=duration)), (20.0 + duration, RobotSpeech(active=False))]
        record = converse([*present(40.0, period=0.8), *says(3.0, 15.0), *speech], 35.0, seed=seed)
        spans = [(3.2, 15.0), (20.0, 20.0 + duration), (20.0, 21.0), (19.0 + duration, 20.0 + duration)]
        fractions.append([record.looking_fraction(*span) for span in spans])
    listening, speaking, first, last = np.mean(fractions, axis=0)
    assert 0.68 <= listening <= 0.82
    assert 0.38 <= speaking <= 0.52
    assert first <= 0.3
    assert last >= 0.9


def test_listening_robot_never_looks_at_the_person_longer_than_the_maximum():
    record = converse([*present(60.0), *says(1.0, 60.0)], 60.0)
    looks = record.of(Look)
    spells = [after - before for (before, want), (after, _) in pairwise(looks) if not any(want.away)]
    assert len(spells) > 8
    assert max(spells) <= 6.0


def test_listening_robot_nods_at_pauses_within_the_limits_of_its_nod_rate():
    events = present(120.0)
    begin = 1.0
    while begin < 118.0:
        events += says(begin, begin + 1.2)
        begin += 1.6
    nods = [time for time, _ in converse(events, 119.0).of(Nod)]
    assert len(nods) >= 12
    assert min(np.diff(nods)) >= MOVEMENT_SETTINGS.nod_interval
    assert max(sum(0 <= time - start < 60.0 for time in nods) for start in nods) <= MOVEMENT_SETTINGS.nods_per_minute
    ends = np.arange(2.2, 119.0, 1.6)
    delays = [min(time - ends[ends < time]) for time in nods]
    assert max(delays) == pytest.approx(MOVEMENT_SETTINGS.pause_before_nod, abs=0.01)


def test_listening_robot_may_nod_at_a_clause_end_in_the_transcript():
    spoken = [(2.0, VoiceActivity(active=True)), (4.0, Transcript("When I was young,"))]
    nods = [converse([*present(5.0), *spoken], 5.0, seed=seed).of(Nod) for seed in range(8)]
    assert any(nods)
    assert all(time == 4.0 for record in nods for time, _ in record)
    assert not any(converse([*present(5.0), *spoken[:1]], 5.0, seed=seed).of(Nod) for seed in range(8))


def test_speaking_robot_never_nods():
    assert converse([*present(20.0), (1.0, RobotSpeech(active=True)), *says(3.0, 3.3)], 20.0).of(Nod) == []


def test_thinking_robot_looks_up_and_requests_two_fillers():
    ups = []
    for seed in range(20):
        record = converse([*present(12.0, period=0.8), (2.0, Thinking(on=True))], 12.0, seed=seed)
        assert [round(time - 2.0, 2) for time, _ in record.of(Filler)] == list(MOVEMENT_SETTINGS.fillers)
        first = next(want for time, want in record.of(Look) if time >= 2.0)
        assert any(first.away)
        ups.append(first.away[1] > 0)
    assert 10 <= sum(ups) <= 18
    assert (
        time_of(converse([*present(6.0), (2.0, Thinking(on=True)), (4.0, Thinking(on=False))], 6.0), "thinking") == 2.0
    )


def test_thinking_that_no_client_requested_ends_after_a_maximum_time():
    record = converse([*present(20.0), *says(2.0, 4.0)], 20.0)
    assert record.modes()[-1][1] == "attending"
    assert record.modes()[-1][0] == pytest.approx(5.0 + TURN_TIMES.longest_unasked_thinking, abs=0.01)


def test_listening_robot_leans_forward_and_returns_upright_afterwards():
    record = converse([*present(8.0), *says(2.0, 4.0)], 8.0, amount=0.5)
    lean, upright = (want for _, want in record.of(BodyLean))
    assert (lean.lean, abs(lean.tilt)) == (0.5 * MODE_BEARINGS["listening"].lean, 0.5 * MODE_BEARINGS["listening"].tilt)
    assert (upright.lean, upright.tilt) == (0.5 * MODE_BEARINGS["thinking"].lean, 0.0)


def test_each_change_of_state_requests_the_expression_of_the_new_state_once():
    record = converse([*present(9.0), *says(2.0, 4.0), (5.2, RobotSpeech(active=True, ends_in=2.0))], 8.0, amount=0.5)
    held = [(want.reason, want.units) for _, want in record.of(HeldExpression)]
    assert [reason for reason, _ in held] == ["attending", "listening", "thinking", "speaking"]
    assert held[1][1] == tuple((unit, 0.5 * value) for unit, value in MODE_BEARINGS["listening"].face)
    assert held[3][1] == ()


def test_idle_robot_looks_around_with_its_head():
    looks = [want for time, want in converse([], 30.0).of(Look) if time > 12.0]
    away = [look for look in looks if look.away != (0.0, 0.0)]
    assert len(away) >= 3
    assert all(look.place is None and look.head_fraction > 0.0 for look in away)


def test_conversation_without_people_becomes_idle_after_a_while():
    record = converse([*present(3.0)], 20.0)
    assert record.modes()[-1] == (pytest.approx(2.9 + 1.0 + TURN_TIMES.absence_to_idle, abs=0.15), "idle")
    assert record.of(Look)[-1][1].place is None


def test_robot_without_reports_of_people_attends_to_a_voice():
    record = converse(says(2.0, 4.0, who=None), 25.0)
    assert [mode for _, mode in record.modes()] == ["attending", "listening", "thinking", "attending", "idle"]
    assert all(want.place is None for _, want in record.of(Look))


def test_gaze_ignores_small_movements_of_a_person_and_limits_the_rate_of_corrections():
    """A person first sways by 4 cm, then walks at 1 m/s."""
    sides = [*(0.04 * (k % 2) for k in range(20)), *(0.05 * k for k in range(20))]
    walk = [(0.05 * k, PeopleSeen((Person("p", (1.5, side, 1.5)),))) for k, side in enumerate(sides)]
    looks = [time for time, want in converse(walk, 1.98).of(Look) if time > 0.0 and not any(want.away)]
    assert len(looks) >= 3
    assert looks[0] > 1.0
    assert min(np.diff(looks)) >= MOVEMENT_SETTINGS.shortest_look_interval - 1e-3


def test_robot_looks_at_the_speaker_among_several_people():
    two = (Person("a", FRONT, looks=True), Person("b", LEFT, looks=True))
    record = converse([*present(12.0, *two), *says(4.0, 11.0, "b")], 11.0)
    assert record.mode_at(5.0) == "listening"
    assert [want.who for time, want in record.of(ModeNotice) if time > 4.0][-1] == "b"
    met = [want.place for time, want in record.of(Look) if time > 5.0 and not any(want.away)]
    assert met
    assert all(place == pytest.approx(LEFT) for place in met)


def test_conversation_switched_off_has_mode_off_and_forgets_all_people():
    record = converse([*present(3.0), (3.0, Conversing(on=False)), *present(5.0, begin=3.1)], 6.0)
    assert record.modes()[-1] == (3.0, "off")
    assert record.states[-1][1].company.tracked == ()
    assert next_time(record.states[-1][1], 6.0) == float("inf")


def test_conversation_is_reproducible_by_seed_and_differs_between_seeds():
    events = [*present(20.0), *says(2.0, 9.0), (10.0, Thinking(on=True))]
    one, same, other = (converse(events, 20.0, seed=seed).wants for seed in (1, 1, 2))
    assert one == same
    assert one != other


def test_additional_time_steps_between_events_do_not_change_the_conversation():
    events = [*present(15.0), *says(2.0, 9.0), (10.0, Thinking(on=True))]
    record, state, often, now = converse(events, 14.0), ConversationState(), [], 0.0
    queue = sorted([(0.0, Conversing(on=True)), *events], key=lambda pair: pair[0])
    while now <= 14.0:
        due = min(next_time(state, now, words=ENGLISH), now + 0.013)
        event = queue.pop(0) if queue and queue[0][0] <= due else None
        now = due if event is None else event[0]
        state, wants = advance_conversation(state, None if event is None else event[1], now, words=ENGLISH)
        often += [(now, want) for want in wants]
    assert [want for time, want in often if time <= 14.0] == [want for _, want in record.wants]


def test_stop_words_and_words_of_unfinished_turns_are_detected_in_english_and_japanese():
    english, japanese = turn_words("en-GB"), turn_words("ja")
    assert english.has_stop_word("Okay, hold on a second")
    assert not english.has_stop_word("nobody stopped")
    assert english.is_unfinished("I like it because")
    assert not english.is_unfinished("I like the band")
    assert japanese.has_stop_word("はい、待って")
    assert japanese.is_unfinished("行きたいけど")
    assert turn_words("sw") == NO_TURN_WORDS
    assert all(turn_words(tag).fillers for tag in ("de", "en", "es", "fr", "it", "ja", "nl", "pt"))


def test_end_report_that_arrives_after_the_next_start_of_a_voice_is_ignored():
    late = [(4.08, VoiceActivity(active=True, who="p1", age=0.08)), (4.1, VoiceActivity(active=False, age=0.3))]
    begun = VoiceActivity(active=True, who="p1")
    record = converse([*present(9.0), (2.0, begun), *late, (7.0, VoiceActivity(active=False, who="p1"))], 9.0)
    assert time_of(record, "thinking") == pytest.approx(7.0 + 0.7 + 0.3, abs=0.01)


def test_end_report_after_the_latest_start_of_a_voice_ends_the_turn():
    restarted = [(2.0, VoiceActivity(active=True)), (4.0, VoiceActivity(active=True, age=0.1))]
    record = converse([*present(9.0), *restarted, (5.0, VoiceActivity(active=False, age=1.0))], 9.0)
    assert time_of(record, "thinking") == pytest.approx(5.0, abs=0.01)
