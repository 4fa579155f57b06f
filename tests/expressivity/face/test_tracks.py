from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.block import Face, Speech, Timeline
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.action_units import FACE_CHANNELS, MAX_EYE_ELEVATION
from kinesic.body.command import NO_FACE
from kinesic.body.utterance import Utterance
from kinesic.expressivity.face.eyes import Eyes, GazeDirection, Habits, gaze_units, saccade_offsets
from kinesic.expressivity.face.tracks import Channels, face_at_ticks, face_outcome, face_track
from kinesic.expressivity.keyframes import BodyMove
from kinesic.expressivity.prosody import Prosody, find_phrase_ends
from kinesic.expressivity.style.resolve import resolve_styles
from kinesic.expressivity.style.style import Expressivity, Style
from kinesic.speech.durations import DurationModel

SAMPLE_TIMES = np.arange(-0.5, 8.0, 0.01)


def scheduled(inside: str) -> tuple[Timeline, dict[str, Utterance]]:
    block = parse(f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{inside}</bml>')
    said = {
        behaviour.id: DurationModel().say(behaviour.action.script)
        for behaviour in block.behaviours
        if isinstance(behaviour.action, Speech)
    }
    return schedule(block, said, {}), said


def show(timeline: Timeline, said: dict[str, Utterance], times=SAMPLE_TIMES, style=None, **eyes) -> Channels:
    styles = resolve_styles(style or Style(), timeline.block)
    return face_track(timeline, said, times, styles=styles, eyes=Eyes(**eyes))


def at(values: np.ndarray, time: float) -> float:
    return float(np.interp(time, SAMPLE_TIMES, values))


def test_intensity_of_a_facial_expression_follows_its_sync_points():
    timeline, said = scheduled(
        '<faceLexeme id="f" lexeme="RAISE_BROWS" amount="0.6" start="1" attackPeak="1.5" relax="3" end="4"/>'
    )
    result = show(timeline, said, SAMPLE_TIMES)
    assert result.keys() == {"L1", "R1", "L2", "R2"}
    for time, share in ((0.9, 0.0), (1.25, 0.5), (1.5, 1.0), (3.0, 1.0), (3.5, 0.5), (4.01, 0.0)):
        assert at(result["L1"], time) == pytest.approx(0.6 * share, abs=1e-3)


def test_stronger_of_two_overlapping_facial_expressions_is_shown():
    weak = '<faceLexeme id="f" lexeme="RAISE_BROWS" amount="0.3" start="0" attackPeak="0.5" relax="5" end="6"/>'
    strong = '<faceLexeme id="g" lexeme="RAISE_LEFT_BROW" amount="0.8" start="2" attackPeak="2.5" relax="3" end="4"/>'
    result = show(*scheduled(weak + strong), SAMPLE_TIMES)
    assert at(result["L1"], 2.7) == pytest.approx(0.8)
    assert at(result["R1"], 2.7) == pytest.approx(0.3)
    assert at(result["L1"], 4.5) == pytest.approx(0.3)


def test_permanent_expression_is_replaced_by_the_next_permanent_expression():
    result = show(
        *scheduled(
            '<faceShift id="f" lexeme="joy" amount="1" start="0" end="1"/>'
            '<faceShift id="g" lexeme="sadness" amount="1" start="3" end="4"/>'
        ),
        SAMPLE_TIMES,
    )
    assert at(result["L12"], 2.0) == pytest.approx(1.0)
    assert at(result["L12"], 5.0) == pytest.approx(0.0, abs=1e-9)
    assert at(result["L15"], 2.0) == pytest.approx(0.0, abs=1e-9)
    assert at(result["L15"], 7.0) == pytest.approx(0.9)


def test_affect_of_the_style_is_shown_while_the_document_shows_no_expression():
    timeline, said = scheduled(
        '<faceLexeme id="f" lexeme="RAISE_BROWS" amount="0.6" start="2" attackPeak="2.5" relax="4" end="5"/>'
    )
    styles = resolve_styles(Style(), timeline.block)
    result = face_track(timeline, said, SAMPLE_TIMES, styles=styles, affect={"joy": 0.4})
    for time, intensity in ((1.0, 0.4), (3.0, 0.0), (6.0, 0.4)):
        assert at(result["L12"], time) == pytest.approx(intensity, abs=1e-6)
    assert at(result["L1"], 3.0) == pytest.approx(0.6)


def test_facial_expression_uses_the_face_and_not_the_head_expressivity():
    asked = scheduled('<faceLexeme id="f" lexeme="smile" start="1" attackPeak="1.5" relax="3" end="4"/>')
    wide = Expressivity(spatial=0.5)
    plain, own, other = (
        show(*asked, SAMPLE_TIMES, style=style)["L12"] for style in (Style(), Style(face=wide), Style(head=wide))
    )
    np.testing.assert_array_equal(other, plain)
    assert own.max() == pytest.approx(1.25 * plain.max())


def test_high_fluidity_joins_successive_facial_expressions():
    asked = scheduled(
        '<faceLexeme id="f" lexeme="smile" start="1" attackPeak="1.3" relax="2" end="2.4"/>'
        '<faceLexeme id="g" lexeme="RAISE_BROWS" start="2.7" attackPeak="3" relax="4" end="4.4"/>'
    )
    plain, flowing = (show(*asked, SAMPLE_TIMES, style=Style(face=Expressivity(fluidity=f)))["L12"] for f in (0.0, 0.5))
    assert at(plain, 2.6) == 0.0
    assert at(flowing, 2.6) > 0.05
    assert at(flowing, 3.01) == 0.0
    assert at(flowing, 2.0) == at(plain, 2.0)
    far = show(*asked, SAMPLE_TIMES, style=Style(face=Expressivity(fluidity=0.2)))["L12"]
    np.testing.assert_array_equal(far, plain)
    longest = scheduled(
        '<faceLexeme id="f" lexeme="smile" start="1" attackPeak="1.3" relax="1.5" end="2"/>'
        '<faceLexeme id="g" lexeme="RAISE_BROWS" start="2.5" attackPeak="3" relax="4" end="4.4"/>'
    )
    assert at(show(*longest, SAMPLE_TIMES, style=Style(face=Expressivity(fluidity=0.5)))["L12"], 2.2) > 0.05


def test_repeated_blink_lexeme_of_1_5_s_blinks_five_times():
    result = show(
        *scheduled('<faceLexeme id="f" lexeme="REPEATED_BLINK" start="1" attackPeak="1.1" relax="2.4" end="2.5"/>'),
        SAMPLE_TIMES,
    )
    closed = result["L45"] > 0.8
    assert np.sum(np.diff(closed.astype(int)) == 1) == 5


def test_speech_moves_the_mouth_and_opens_pressed_lips():
    speech = '<speech id="s" start="1"><text>Mama, papa, hello everybody</text></speech>'
    angry = '<faceLexeme id="f" lexeme="anger" amount="1" start="0" attackPeak="0.5" relax="6" end="7"/>'
    timeline, said = scheduled(speech + angry)
    result = show(timeline, said, SAMPLE_TIMES)
    for sound in said["s"].phonemes:
        middle = 1.0 + sound.start + sound.duration / 2
        if sound.symbol in "pbm":
            assert at(result["24"], middle) == pytest.approx(1.0, abs=0.01)
        elif sound.symbol == "a" and sound.duration > 0.08:
            assert at(result["24"], middle) < 0.2
            assert at(result["26"], middle) > 0.25
    assert at(result["24"], 0.8) == pytest.approx(0.5)
    assert at(result["L4"], 2.0) == pytest.approx(1.0)


def test_face_blinks_and_makes_saccades_only_if_requested():
    timeline, said = scheduled('<wait id="w" duration="1"/>')
    assert show(timeline, said, SAMPLE_TIMES) == {}
    lively = show(timeline, said, SAMPLE_TIMES, habits=Habits(seed=3))
    assert {"L45", "R45"} <= lively.keys() <= set(FACE_CHANNELS)
    still = show(timeline, said, SAMPLE_TIMES, habits=Habits(seed=3, saccades=False))
    assert still.keys() == {"L45", "R45"}


def test_eyes_blink_before_a_speech():
    result = show(
        *scheduled('<speech id="s" start="2"><text>Hello</text></speech>'), SAMPLE_TIMES, habits=Habits(seed=0)
    )
    assert result["L45"][(SAMPLE_TIMES > 1.85) & (SAMPLE_TIMES < 2.0)].max() == pytest.approx(1.0)


def test_gaze_turns_the_eyes_and_a_near_target_makes_them_converge():
    timeline, said = scheduled('<wait id="w" duration="1"/>')
    result = show(timeline, said, SAMPLE_TIMES, looks=[GazeDirection(1.0, -0.4, 0.0, 3.0)])
    assert result.keys() == {"62"}
    near = show(timeline, said, SAMPLE_TIMES, looks=[GazeDirection(1.0, -0.4, 0.0, 3.0, 0.25)])
    assert near.keys() == {"62", "66"}
    assert at(result["62"], 2.0) > 0.5


def test_eyes_counter_rotate_to_look_ahead_while_the_head_nods():
    timeline, said = scheduled('<wait id="w" duration="1"/>')
    nod = np.zeros((len(SAMPLE_TIMES), 2))
    nod[:, 1] = -0.3 * np.exp(-((SAMPLE_TIMES - 2.0) ** 2) / 0.02)
    result = show(timeline, said, SAMPLE_TIMES, head=nod)
    assert result.keys() == {"63"}
    np.testing.assert_allclose(result["63"] * MAX_EYE_ELEVATION, -nod[:, 1], atol=1e-12)


def test_face_of_a_command_has_the_action_units_of_the_command_time():
    timeline, said = scheduled('<faceLexeme id="f" lexeme="smile" start="1" attackPeak="1.5" relax="3" end="4"/>')
    result = show(timeline, said, SAMPLE_TIMES)
    rows = list(face_at_ticks(result, len(SAMPLE_TIMES)))
    assert len(rows) == len(SAMPLE_TIMES)
    assert rows[0] is NO_FACE
    k = int(np.searchsorted(SAMPLE_TIMES, 2.0))
    assert rows[k] == {channel: values[k] for channel, values in result.items()}
    assert list(face_at_ticks({}, 2)) == [NO_FACE, NO_FACE]


def test_face_track_without_sample_times_has_no_action_units():
    timeline, said = scheduled('<faceLexeme id="f" lexeme="smile"/>')
    assert show(timeline, said, np.zeros(0), habits=Habits()) == {}


@pytest.mark.parametrize(
    ("action", "kind", "why"),
    [
        (Face(("joy",)), "realised", ""),
        (Face(("joy", "Qwrtz")), "substituted", "no expression for Qwrtz"),
        (Face(("Qwrtz",)), "dropped", "no expression for Qwrtz"),
        (Face(action_unit=12), "realised", ""),
        (Face(action_unit=99), "dropped", "no action unit 99; known"),
    ],
)
def test_face_behaviour_outcome_depends_on_known_lexemes_and_action_units(action: Face, kind: str, why: str):
    outcome = face_outcome(action)
    assert outcome.kind == kind
    assert outcome.why.startswith(why)


def test_action_units_of_the_eyes_contain_saccades():
    timeline, said = scheduled('<wait id="w" start="0" end="8"/>')
    shown = show(timeline, said, habits=Habits(blinks=False, saccades=True, seed=3))
    strayed = saccade_offsets((float(SAMPLE_TIMES[0]), float(SAMPLE_TIMES[-1])), SAMPLE_TIMES, 3)
    for channel, values in gaze_units(strayed).items():
        np.testing.assert_allclose(shown.get(channel, 0.0) * np.ones(len(SAMPLE_TIMES)), values, atol=1e-12)


def test_gesture_expression_peaks_at_stroke_and_decays_with_retraction():
    timeline, said = scheduled(
        '<gesture id="g" lexeme="beat" start="1" ready="1.8" strokeStart="1.8" stroke="2" strokeEnd="2.2" relax="3" '
        'end="4"/>'
    )
    styles = resolve_styles(Style(), timeline.block)
    bodies = {"g": BodyMove(face=(("smile", 0.5),))}
    shown = face_track(timeline, said, SAMPLE_TIMES, styles=styles, bodies=bodies)
    assert shown
    for values in shown.values():
        assert at(values, 0.9) == at(values, 4.1) == 0.0
        assert at(values, 2.0) == at(values, 3.0) == pytest.approx(values.max())
        assert 0.0 < at(values, 1.6) < values.max()


def test_face_with_a_known_and_an_unknown_lexeme_is_reported_as_substituted_with_the_unknown_one():
    outcome = face_outcome(Face(("smile", "xyzzy")))
    assert (outcome.kind, "xyzzy" in outcome.why) == ("substituted", True)


def show_prosody(inside: str, amount: float = 1.0, style=None, times=SAMPLE_TIMES, **eyes) -> Channels:
    timeline, said = scheduled(inside)
    styles = resolve_styles(style or Style(), timeline.block)
    return face_track(timeline, said, times, styles=styles, eyes=Eyes(**eyes), prosody=Prosody(amount))


TALK = (
    '<speech id="s" start="0"><text>There was a garden, and a man came to it on every morning of May.</text></speech>'
)


def test_speech_prosody_raises_the_brows_more_with_higher_amount_and_spatial_extent():
    raised = show_prosody(TALK)["L2"]
    assert raised.max() >= 0.25
    assert "L2" not in show_prosody(TALK, 0.0)
    assert show_prosody(TALK, 1.5)["L2"].max() > 1.4 * raised.max()
    wide = show_prosody(TALK, style=Style(face=Expressivity(spatial=0.8)))["L2"]
    assert wide.max() > 1.3 * raised.max()


def test_brows_ignore_speech_accents_during_an_expression_of_the_document():
    frown = '<faceLexeme id="f" lexeme="joy" amount="0.6" start="0" attackPeak="0.2" relax="7" end="7.5"/>'
    alone, directed = show_prosody(TALK), show_prosody(TALK + frown)
    during = (SAMPLE_TIMES > 0.3) & (SAMPLE_TIMES < 6.9)
    assert alone["L2"][during].max() > 0.2
    assert directed.get("L2", np.zeros(len(SAMPLE_TIMES)))[during].max() < 1e-6


def test_angry_affect_of_a_style_reduces_brow_raises_on_speech_accents():
    timeline, said = scheduled(TALK)
    styles = resolve_styles(Style(), timeline.block)
    free, frowning = (
        face_track(timeline, said, SAMPLE_TIMES, styles=styles, affect=affect, prosody=Prosody(1.0))["L2"].max()
        for affect in ({}, {"anger": 0.5})
    )
    assert frowning < 0.8 * free


def test_eyes_blink_at_the_ends_of_phrases_only_with_prosody():
    _, said = scheduled(TALK)
    ends = np.array(find_phrase_ends(said["s"]))
    times = np.arange(-0.5, 8.0, 0.005)
    with_prosody, without = (show_prosody(TALK, amount, times=times, habits=Habits(2))["L45"] for amount in (1.0, 0.0))
    closing = times[1:][(with_prosody[1:] > 0.0) & (with_prosody[:-1] == 0.0)]
    assert len(ends) >= 2
    assert all(np.abs(closing - end).min() < 0.02 for end in ends)
    plain = times[1:][(without[1:] > 0.0) & (without[:-1] == 0.0)]
    assert not all(np.abs(plain - end).min() < 0.02 for end in ends)


def test_loud_sounds_open_the_jaw_further_with_prosody():
    timeline, said = scheduled(TALK)
    loud = {"s": replace(said["s"], phonemes=tuple(replace(p, opening=1.3) for p in said["s"].phonemes))}
    styles = resolve_styles(Style(), timeline.block)
    still, moved = (
        face_track(timeline, loud, SAMPLE_TIMES, styles=styles, prosody=Prosody(amount))["26"].max()
        for amount in (0.0, 1.0)
    )
    assert moved > 1.1 * still
