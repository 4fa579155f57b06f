from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from kinesic.bml.block import Speech
from kinesic.bml.parse import parse
from kinesic.body.utterance import Mark, Pause, Script, Sound, Utterance
from kinesic.expressivity.hands.busy_hands import BusyHand
from kinesic.expressivity.style.style import Expressivity, Style
from kinesic.planning import plan as plan_module
from kinesic.planning import speech
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup
from kinesic.planning.speech import SpeechPause, choose_rate_and_pitch, insert_pauses
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.report.report import feedback
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.speech.espeak_pool import espeak_fault

# speech with three gestures that need more time than the words
HURRIED_DOCUMENT = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic" id="b" {block}>
  <speech id="s" {speech}>
    <text>See <sync id="a"/>this, <sync id="b"/>this and <sync id="c"/>that one.</text>
  </speech>
  <gesture id="g1" lexeme="offer" mode="RIGHT_HAND" stroke="s:a"/>
  <gesture id="g2" lexeme="large" mode="BOTH_HANDS" stroke="s:b"/>
  <gesture id="g3" lexeme="greet_wave" mode="RIGHT_HAND" stroke="s:c"/>
</bml>
"""
GESTURE_MARKS = {"g1": "a", "g2": "b", "g3": "c"}  # gesture -> mark of its stroke


# runs a test with one voice, if the voice does not matter
SILENT_VOICE = pytest.mark.parametrize("known", ["durations"], indirect=True)
# runs a test with the other voice only in `make soak`
MAINLY_SILENT_VOICE = pytest.mark.parametrize(
    "known", ["durations", pytest.param("espeak", marks=pytest.mark.soak)], indirect=True
)


@cache
def hurried(known: Setup, *, block: str = "", speech: str = "") -> Plan:
    return plan(HURRIED_DOCUMENT.format(block=block, speech=speech), known)


def missed(planned: Plan) -> Iterator[float]:
    """Return the time between each stroke and its word [s]."""
    said = planned.utterances["s"].marks
    start = next(t.times["start"] for t in planned.timeline.timed if isinstance(t.behaviour.action, Speech))
    for sync in planned.syncs:
        if sync.sync == "stroke" and sync.behaviour in GESTURE_MARKS:
            yield abs(sync.planned - start - said[GESTURE_MARKS[sync.behaviour]])


def pauses(planned: Plan) -> list[str]:
    return [notice.text for notice in planned.notices if notice.text.startswith("a pause of")]


@pytest.fixture(scope="module", params=["durations", "espeak"])
def known(request: pytest.FixtureRequest) -> Setup:
    if request.param == "espeak" and espeak_fault():
        pytest.skip(espeak_fault())
    return set_up(voice=request.param)


@pytest.fixture(scope="module")
def waiting(known: Setup) -> Plan:
    return hurried(known, speech='kinesic:pause="true"')


def test_speech_pauses_until_the_gesture_is_ready_if_allowed(known: Setup, waiting: Plan):
    assert max(missed(hurried(known))) > 5 * SHIFT_TO_WARN
    assert max(missed(waiting)) <= SHIFT_TO_WARN
    assert pauses(waiting)


def test_pause_notice_names_word_and_gesture(waiting: Plan):
    assert any("before 'that' (mark c), so that stroke of 'g3' is in time" in text for text in pauses(waiting))
    warnings = [text for text in feedback(waiting) if "a pause of" in text]
    assert len(warnings) == len(pauses(waiting))


def test_mark_times_in_prediction_feedback_include_speech_pauses(waiting: Plan):
    prediction = next(iter(feedback(waiting)))
    said = waiting.utterances["s"]
    start = next(t.times["start"] for t in waiting.timeline.timed if t.behaviour.id == "s")
    assert f'<sync id="c" time="{round(start + said.marks["c"], 6)!r}"' in prediction


@SILENT_VOICE
def test_speech_pauses_are_inserted_only_if_allowed(known: Setup):
    without = hurried(known)
    assert pauses(without) == []
    assert hurried(known, block='kinesic:pause="0.3"', speech='kinesic:pause="false"').utterances == without.utterances


@MAINLY_SILENT_VOICE
def test_speech_pauses_stay_within_their_requested_limit(known: Setup):
    planned = hurried(known, block='kinesic:pause="0.12"')
    assert pauses(planned)
    assert all(float(text.split()[3]) <= 0.12 for text in pauses(planned))
    usual = hurried(known).utterances["s"].marks
    said = planned.utterances["s"].marks
    assert said["b"] - usual["b"] <= 0.12 + 0.03  # what is said before a pause sounds otherwise
    assert said["c"] - usual["c"] <= 0.24 + 0.06


@SILENT_VOICE
def test_voice_that_ignores_pauses_is_retried_three_times(known: Setup, monkeypatch: pytest.MonkeyPatch):
    requested: list[tuple[SpeechPause, ...]] = []
    usual = hurried(known).utterances
    monkeypatch.setattr(
        plan_module, "synthesise_block", lambda block, setup, pauses=(): requested.append(pauses) or usual
    )
    planned = plan(HURRIED_DOCUMENT.format(block="", speech='kinesic:pause="true"'), known)
    assert requested[0] == ()
    assert len(requested) == 4
    assert pauses(planned) == []


@pytest.mark.soak
def test_setup_option_pause_is_the_default_maximum_speech_pause():
    usual = set_up(voice="durations", pause=2.0)
    assert max(missed(hurried(usual))) <= SHIFT_TO_WARN
    assert pauses(hurried(usual, block='kinesic:pause="false"')) == []


def test_speech_whose_gesture_is_on_time_has_no_pause(known: Setup):
    text = (
        '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b" kinesic:pause="true">'
        '<speech id="s"><text>My two hands can do <sync id="m"/>this</text></speech>'
        '<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="s:m"/></bml>'
    )
    planned = plan(text, known)
    assert planned.notices == ()
    assert planned.utterances["s"].marks == plan(text.replace("true", "false"), known).utterances["s"].marks


def test_planning_keeps_utterances_given_by_the_caller(known: Setup, waiting: Plan):
    again = plan_block(waiting.timeline.block, known, utterances=waiting.utterances)
    assert again.utterances == waiting.utterances
    assert pauses(again) == []


@SILENT_VOICE
def test_planning_uses_the_timeline_given_by_the_caller_unless_pauses_or_busy_hands_change_it(known: Setup):
    plain, paused = (parse(HURRIED_DOCUMENT.format(block="", speech=speech)) for speech in ("", 'kinesic:pause="true"'))
    without_pause = plan_block(paused, known, utterances=speech.synthesise_block(paused, known)).timeline
    first = plan_block(plain, known)
    assert plan_block(plain, known, timeline=first.timeline).timeline is first.timeline
    waiting = plan_block(paused, known, timeline=without_pause)
    assert pauses(waiting)
    assert [timed.times for timed in waiting.timeline.timed] == [
        timed.times for timed in plan_block(paused, known).timeline.timed
    ]
    busy = (BusyHand("r", 50.0, 51.0, "other:g"),)
    assert plan_block(plain, known, timeline=first.timeline, busy_hands=busy).timeline is not first.timeline


def test_speech_pause_is_inserted_before_its_mark():
    script = Script("one two", (Mark("a", 4), Mark("b", 4)), pauses=(Pause(4, 0.1),))
    result = insert_pauses(
        script, (SpeechPause("s", "b", 0.0, ("g", "stroke"), 0.2, 0.2), SpeechPause("s", "a", 0.0, ("g", "stroke")))
    )
    assert result.stops() == (Pause(4, 0.1), Mark("a", 4), Pause(4, 0.2, 1), Mark("b", 4))


@SILENT_VOICE
def test_recorded_speech_gets_no_pause(known: Setup, tmp_path: Path):
    text = HURRIED_DOCUMENT.format(block='kinesic:pause="true"', speech="").replace(
        "</speech>", '<description type="audio/wav" ref="missing.wav"/></speech>'
    )
    planned = plan(text, known, source=str(tmp_path / "hurried.bml"))
    assert pauses(planned) == []
    assert any("missing.wav" in notice.text for notice in planned.notices)


class LongVoice:
    """Voice with 700 s for each speech, at a low rate."""

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        return Utterance(700.0, sound=Sound.of(10, np.zeros(7000)))


def test_speeches_beyond_the_maximum_sound_duration_are_silent_with_a_notice(known: Setup):
    speeches = "".join(f'<speech id="s{k}" start="0"><text>Yes.</text></speech>' for k in range(40))
    text = f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{speeches}</bml>'
    planned = plan_block(parse(text), replace(known, voice=LongVoice()))
    heard = [id for id, said in planned.utterances.items() if said.sound is not None]
    assert heard == ["s0", "s1", "s2", "s3"]
    warned = {notice.id for notice in planned.notices if "no sound: " in notice.text}
    assert warned == {f"b:s{k}" for k in range(4, 40)}
    assert all(said.duration == 700.0 for said in planned.utterances.values())


class SilentThenLoudVoice(LongVoice):
    """Voice whose first hundred speeches are silent."""

    def __init__(self) -> None:
        self.said = 0

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        self.said += 1
        return Utterance(700.0) if self.said <= 100 else super().say(script, rate=rate, pitch=pitch)


def test_silent_speech_does_not_count_towards_the_maximum_sound_duration(known: Setup, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(speech, "MAX_SOUND_DURATION", 50.0)
    speeches = "".join(f'<speech id="s{k}" start="0"><text>Yes.</text></speech>' for k in range(103))
    block = parse(f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{speeches}</bml>')
    said = speech.synthesise_block(block, replace(known, voice=SilentThenLoudVoice()))
    assert [id for id, utterance in said.items() if utterance.sound is not None] == ["s100"]


def test_style_changes_speech_rate_and_pitch(known):
    def spoken(**numbers) -> tuple[float, float]:
        return choose_rate_and_pitch(Style.uniform(Expressivity(**numbers)))

    assert spoken() == (1.0, 1.0)
    assert spoken(temporal=1.0) == pytest.approx((1.25, 1.0))
    assert spoken(temporal=-1.0) == pytest.approx((0.8, 1.0))
    assert spoken(power=1.0, activation=1.0) == pytest.approx((1.0, 2 ** (3 / 12)))
    assert spoken(power=-1.0) == pytest.approx((1.0, 2 ** (-1.5 / 12)))
