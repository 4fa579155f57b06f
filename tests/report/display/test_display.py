"""HTML representations of objects in notebooks."""

import base64
import hashlib
import io
import re
import wave
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.body.utterance import Sound
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import MODALITIES, Style
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.report.display import make_html
from kinesic.report.display.frame import MAX_DISPLAY_FRAMES, MAX_DISPLAY_SIZE
from kinesic.report.run import Performance, performance_of
from kinesic.session.plan import plan

from .frames import angles_of, replay_of, the_frame

MAX_REPR_LENGTH = 250  # [characters] longest text representation of an object
ANGLE_TOLERANCE = 1e-4  # [rad] tolerance of angles stored as 16-bit integers


@pytest.fixture(scope="module")
def run(hurried: DryRun) -> Performance:
    return performance_of(hurried, seed=0)


@pytest.fixture(scope="module")
def run_html(run: Performance) -> str:
    return run._repr_html_()


def with_voice(planned: Plan, seconds: float) -> Plan:
    """Return a plan whose speech is audible."""
    heard = Sound.of(16000, np.full(round(16000 * seconds), 0.25, dtype=np.float32))
    return replace(planned, utterances={name: replace(each, sound=heard) for name, each in planned.utterances.items()})


def test_notebook_display_of_a_performance_shows_verdict_replay_and_timeline(run: Performance, run_html: str):
    assert str(run).split(": ", 1)[1] in run_html
    page, replay = the_frame(run_html)["srcdoc"], replay_of(run_html)
    times = np.linspace(0.0, run.duration, replay["frames"])
    assert np.allclose(angles_of(replay, "plan"), run.plan.trajectory.sample(times)[0], atol=ANGLE_TOLERANCE)
    measured = np.stack([np.interp(times, run.measured.times, row) for row in run.measured.angles.T], axis=1)
    assert np.allclose(angles_of(replay, "twin"), measured, atol=ANGLE_TOLERANCE)
    assert "Hello there," in page
    assert page.count("<svg") >= 2
    assert ">offer<" in page
    assert '<td style="text-align:left">limits.speed</td>' in run_html
    assert "behaviour not as requested" in run_html


def test_notebook_display_of_a_plan_replays_the_planned_motion_without_loads(run: Performance):
    html = run.plan._repr_html_()
    replay = replay_of(html)
    assert list(replay["motions"]) == ["twin"]
    times = np.linspace(0.0, run.plan.duration, replay["frames"])
    assert np.allclose(angles_of(replay, "twin"), run.plan.trajectory.sample(times)[0], atol=ANGLE_TOLERANCE)
    page = the_frame(html)["srcdoc"]
    assert '<span data-part="load" hidden>' in page
    assert "<label hidden>compare" in page
    assert "in the twin" not in page
    assert "notice" in html


def test_notebook_display_frame_is_sandboxed_and_allows_only_the_player_script(run_html: str):
    frame = the_frame(run_html)
    assert frame["sandbox"] == "allow-scripts"
    (script,) = re.findall(r"<script>(.*?)</script>", frame["srcdoc"], re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in frame["srcdoc"].replace("&#39;", "'")


def test_markup_in_spoken_words_is_escaped_in_the_notebook_display(known: Setup):
    evil = '"></iframe><script>window.hacked=1</script>'
    words = evil.replace("<", "&lt;").replace('"', "&quot;")
    document = f'<bml id="b"><head id="n" lexeme="NOD" start="0"/><speech id="s"><text>{words}</text></speech></bml>'
    html = plan(document, known, source=evil)._repr_html_()
    assert html.count("<iframe") == html.count("</iframe>") == 1
    assert "<script" not in html
    assert the_frame(html)["title"].startswith(f"plan of {evil}")


def test_speech_is_embedded_in_a_notebook_unless_it_becomes_too_large(run: Performance):
    short = the_frame(with_voice(run.plan, 0.5)._repr_html_())["srcdoc"]
    (data,) = re.findall(r'src="data:audio/wav;base64,([^"]+)"', short)
    with wave.open(io.BytesIO(base64.b64decode(data))) as sound:
        assert sound.getnframes() >= 8000
    assert "left out" not in short
    html = with_voice(run.plan, 60.0)._repr_html_()
    assert len(html) < MAX_DISPLAY_SIZE
    assert "data:audio" not in html
    assert "voice is left out" in html


def test_notebook_replay_of_a_long_motion_has_a_lower_frame_rate(known: Setup):
    document = '<bml id="b"><head id="n" lexeme="NOD" start="0" end="1"/><head id="m" lexeme="NOD" start="40"/></bml>'
    replay = replay_of(plan(document, known)._repr_html_())
    assert replay["frames"] == MAX_DISPLAY_FRAMES
    assert replay["end"] > 40.0


def test_notebook_display_of_a_robot_shows_rest_posture_and_hinges(known: Setup):
    html = known.robot._repr_html_()
    replay = replay_of(html)
    assert np.allclose(angles_of(replay, "twin"), known.robot.skeleton.rest, atol=ANGLE_TOLERANCE)
    assert all(f">{name}</td>" in html for name in known.robot.skeleton.names)
    assert len(html) < MAX_DISPLAY_SIZE


def test_notebook_display_of_a_style_shows_each_parameter_of_each_modality():
    html = Style.load("joyful").changed(["head.power=-0.75"])._repr_html_()
    assert all(f">{modality}</th>" in html for modality in MODALITIES)
    assert html.count("<svg") == 8 * len(MODALITIES)
    assert "\u22120.75" in html


def test_notebook_display_of_a_modified_gesture_shows_the_modified_motion():
    """Display a changed copy of a gesture of the lexicon."""
    match = Lexicon.load().find("beat")
    assert match is not None
    form = match.form
    plain, mirrored = form._repr_html_(), replace(form, keys=form.keys[:1])._repr_html_()
    first, second = (angles_of(replay_of(html), "twin") for html in (plain, mirrored))
    assert first.shape != second.shape or not np.allclose(first, second, atol=0.01)
    assert "beat" in plain


def test_notebook_display_of_a_substituted_gesture_names_the_reason():
    match = Lexicon.load().find("")
    assert match is not None
    assert "substituted by beat: no lexeme" in match._repr_html_()


def test_notebook_display_of_an_unsupported_type_raises_an_error():
    with pytest.raises(TypeError, match="int has no HTML"):
        make_html(1)


def test_text_representations_of_public_objects_are_short(run: Performance, known: Setup):
    match = known.lexicon.find("greet_wave")
    assert match is not None
    shown = (known.robot, known.style, known.lexicon, known, match, match.form, run, run.plan, run.measured)
    assert {type(item).__name__: repr(item) for item in shown if len(repr(item)) > MAX_REPR_LENGTH} == {}
    assert repr(known.robot) == "<robot upper22: 22 hinges, 23 drives, arms of 0.42 m>"
    assert repr(match.form) == "<gesture greet_wave (emblem): right hand, 4 keys, open>"
    assert repr(known.style) == "<style neutral: all parameters of gestures 0>"


def test_notebook_display_of_a_robot_with_skin_stays_below_the_size_limit():
    html = Robot.load("human")._repr_html_()
    assert len(html) < MAX_DISPLAY_SIZE
    assert "skin" in replay_of(html)
