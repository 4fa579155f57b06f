"""Verb `kinesic plan`: timeline, warnings and generated BML."""

import re
import wave
from pathlib import Path
from xml.etree import ElementTree

import pytest

from kinesic import Performer
from kinesic.body.command import SETTLE_DURATION

BLOCK_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
SPOKEN_GESTURE = BLOCK_TEMPLATE.format(
    '<speech id="s"><text>Good <sync id="m"/>morning to you all, wherever you may be today</text></speech>'
    '<head id="h" lexeme="NOD" stroke="s:m"/><gesture id="rushed" lexeme="offer" mode="RIGHT_HAND" start="0" '
    'stroke="0.25" end="0.6"/><gesture id="odd" lexeme="xyzzy"/><faceLexeme id="f" lexeme="smile" start="1" end="2"/>'
).encode()


def test_plan_without_out_prints_a_timeline_and_writes_no_file(kinesic, tmp_path: Path):
    ended = kinesic("plan", "-", stdin=SPOKEN_GESTURE)
    assert ended.code == 0, ended.err
    heading, *lines = ended.out.splitlines()
    assert heading.split() == ["from", "to", "behaviour", "action", "sync", "points"]
    rows = [line.split() for line in lines[:-2] if not line.startswith(" " * 15)]  # without continuation lines
    assert {row[2] for row in rows} == {"s", "h", "rushed", "f"}, "dropped behaviours have no time"
    assert [float(row[0]) for row in rows] == sorted(float(row[0]) for row in rows)
    for shown in ('s          "Good morning to you all, where..."', "head NOD", "gesture offer", "smile"):
        assert shown in ended.out
    assert lines[-1].startswith("nothing written; --out motion.npz")
    assert list(tmp_path.iterdir()) == []


def test_plan_prints_the_duration_of_the_whole_performance_even_if_the_motion_is_shorter(kinesic):
    smile = BLOCK_TEMPLATE.format('<head id="h" lexeme="NOD"/><faceLexeme id="f" lexeme="smile" start="0" end="6"/>')
    planned = Performer("upper22").plan(smile)
    assert planned.trajectory.duration < planned.duration == 6.0
    assert planned.command_times[-1] == pytest.approx(planned.duration + SETTLE_DURATION)
    assert "\n6.00 s, " in kinesic("plan", "-", stdin=smile.encode()).out


def test_timeline_shows_lexicon_entry_and_hands_of_gestures(kinesic):
    lexemes = ("LHandOnHip_Motex", "this_index_RH", "applause", "NOD")
    behaviours = "".join(f'<gesture id="g{k}" lexeme="{name}" start="{4 * k}"/>' for k, name in enumerate(lexemes))
    words = " ".join(kinesic("plan", "-", stdin=BLOCK_TEMPLATE.format(behaviours).encode()).out.split())
    assert "gesture LHandOnHip_Motex as hand_on_hip, left hand ready" in words
    assert "gesture this_index_RH as this_index, right hand ready" in words
    assert "gesture applause, both hands ready" in words
    assert "gesture NOD ready" in words, "the head performs it"


def test_plan_timeline_shows_requested_times_of_moved_sync_points(kinesic):
    ended = kinesic("plan", "-", stdin=SPOKEN_GESTURE)
    moved = re.findall(r"(\w+) (-?[\d.]+) \(requested ([\d.]+)\)", " ".join(ended.out.split()))
    assert {sync for sync, _, _ in moved} >= {"start", "ready"}, "the gesture starts earlier than requested"
    assert "stroke" not in {sync for sync, _, _ in moved}, "the stroke is on time"
    assert all(float(planned) < float(requested) for _, planned, requested in moved)
    assert re.search(r" m 0\.\d\d *$", ended.out, re.MULTILINE)


def test_dropped_behaviours_are_listed_before_other_warnings(kinesic):
    ended = kinesic("plan", "-", stdin=SPOKEN_GESTURE)
    first, *others = ended.err.splitlines()
    assert first.startswith("dropped     xyzzy (odd): ")
    assert any(line.startswith("warning     offer (rushed): ") for line in others)


def test_timeline_of_a_bap_motion_has_no_behaviours(kinesic, tmp_path: Path):
    assert kinesic("plan", "-", "--out", "nod.bap", stdin=SPOKEN_GESTURE).code == 0
    (tmp_path / "nod.bap").rename(tmp_path / "NOD.BAP")
    ended = kinesic("plan", "NOD.BAP")
    assert ended.code == 0, ended.err
    assert ended.out.splitlines()[-1].startswith("nothing written")
    assert "behaviour" not in ended.out


def test_timeline_shows_when_the_hand_is_fastest_for_a_stroke_bound_to_a_word(kinesic):
    tied = SPOKEN_GESTURE.replace(b'start="0" stroke="0.25" end="0.6"', b'stroke="s:m + 1"')
    words = " ".join(kinesic("plan", "-", stdin=tied).out.split())
    stroke, fastest = map(float, re.search(r"stroke ([\d.]+) \(hand fastest at ([\d.]+)\)", words).groups())
    median = float(
        re.search(r"hands are fastest ([\d.]+) s from their times on words \(median, strokes: 1\)", words)[1]
    )
    assert abs(abs(stroke - fastest) - median) < 0.011
    assert "fastest" not in kinesic("plan", "-", stdin=SPOKEN_GESTURE).out


def test_printed_bml_contains_no_terminal_control_characters(kinesic, tmp_path):
    odd = "A\u009b2J\u202e\u0085B"
    fml = (
        f'<fml-apml><bml id="b"><head id="h" lexeme="NOD" x="{odd}"/><speech id="s"><tm id="a"/>{odd}</speech></bml>'
        f'<fml><no type="{odd}" start="s:a"/></fml></fml-apml>'
    )
    (tmp_path / "odd.txt").write_text(odd)
    ended = kinesic("plan", "-", "--to", "bml", stdin=fml.encode())
    assert (ended.code, ended.out.count("A&#155;2J&#8238;&#133;B")) == (0, 2)
    assert r"not shown: no-A\x9b2J\u202e\x85B" in ended.err
    tree = ElementTree.fromstring(ended.out)
    assert [tree.find("head").get("x"), "".join(tree.find("speech").itertext()).strip()] == [odd, odd]
    others = [kinesic("plan", "odd.txt", "--to", "bml"), kinesic("say", odd, "--to", "bml")]
    for run in (ended, *others):
        assert run.code == 0, run.err
        assert all(character.isprintable() or character == "\n" for character in run.out + run.err)


def test_plan_prints_fml_as_bml_and_lists_omitted_intentions(kinesic):
    fml = (
        '<fml-apml><bml><speech id="s"><tm id="a"/>Hello you</speech></bml>'
        '<fml><performative type="greet" start="s:a"/><no type="set" start="s:a"/></fml></fml-apml>'
    )
    ended = kinesic("plan", "-", "--to", "bml", stdin=fml.encode())
    assert ended.code == 0, ended.err
    assert "(performative-greet, 0.50)" in ended.out
    assert "not shown: no-set" in ended.err
    assert kinesic("plan", "-", "--to", "bml", stdin=SPOKEN_GESTURE).code == 2, "the document is BML already"


HURRIED_NODS = BLOCK_TEMPLATE.format(
    '<head id="nods" lexeme="NOD" repetition="3" start="0" end="1.2"/>'
    '<head id="shakes" lexeme="SHAKE" repetition="3" start="1.3" end="2.4"/>'
).encode()


def test_optimal_plan_is_written_to_a_file(kinesic, tmp_path: Path):
    ended = kinesic("plan", "-", "--optimal", "--out", "nods.npz", stdin=HURRIED_NODS)
    assert ended.code == 0, ended.err
    assert (tmp_path / "nods.npz").exists()


def test_plan_refuses_option_optimal_for_a_motion_file(kinesic):
    ended = kinesic("plan", "nod.bap", "--optimal")
    assert ended.code == 2
    assert "nod.bap: --optimal moves the key times of a document" in ended.err


def test_plan_is_written_as_a_scene_or_a_motion_by_its_suffix(kinesic, tmp_path: Path):
    for name, start in (("talk.glb", b"glTF"), ("talk.npz", b"PK"), ("talk.csv", b"time")):
        ended = kinesic("plan", "-", "--out", name, stdin=SPOKEN_GESTURE)
        assert ended.code == 0, ended.err
        assert ended.out.splitlines()[-1] == f"motion: {name}"
        assert (tmp_path / name).read_bytes().startswith(start)
        assert kinesic("plan", "-", "--out", name, stdin=SPOKEN_GESTURE).code == 2, "an existing file is kept"
        assert kinesic("plan", "-", "--out", name, "--force", stdin=SPOKEN_GESTURE).code == 0


def test_plan_writes_the_voice_next_to_a_scene_file(kinesic, tmp_path: Path):
    pytest.importorskip("espeakng_loader", reason="the extra speech is not installed")
    ended = kinesic("plan", "-", "--out", "talk.glb", "--voice", "espeak", stdin=SPOKEN_GESTURE)
    assert ended.code == 0, ended.err
    assert ended.out.splitlines()[-2:] == ["voice: talk.wav", "motion: talk.glb"]
    duration = float(re.search(r"([\d.]+) s, \d+ keys", ended.out)[1])
    with wave.open(str(tmp_path / "talk.wav")) as file:
        assert file.getnframes() / file.getframerate() == pytest.approx(duration, abs=0.01), "both begin together"
    (tmp_path / "talk.glb").unlink()
    ended = kinesic("plan", "-", "--out", "talk.glb", "--voice", "espeak", stdin=SPOKEN_GESTURE)
    assert ended.code == 2, "an existing voice is kept"
    assert not (tmp_path / "talk.glb").exists()


def test_voice_of_a_scene_does_not_replace_the_recording_even_with_force(kinesic, tmp_path: Path):
    with wave.open(str(tmp_path / "talk.wav"), "wb") as file:
        file.setparams((1, 2, 8000, 0, "NONE", ""))
        file.writeframes(bytes(16000))
    recording = (tmp_path / "talk.wav").read_bytes()
    played = '<description type="audio/wav"><audio ref="talk.wav"/></description>'
    spoken = BLOCK_TEMPLATE.format(f'<speech id="s"><text>Hello</text>{played}</speech>')
    (tmp_path / "talk.bml").write_text(spoken)
    ended = kinesic("plan", "talk.bml", "--out", "talk.glb", "--force")
    assert ended.code == 2
    assert "would replace the recording" in ended.err
    assert (tmp_path / "talk.wav").read_bytes() == recording


def test_plan_prints_a_plain_text_file_as_bml(kinesic, tmp_path: Path):
    (tmp_path / "story.txt").write_text("Hello, I never saw three big boxes.")
    ended = kinesic("plan", "story.txt", "--to", "bml")
    assert ended.code == 0, ended.err
    assert ElementTree.fromstring(ended.out).tag.endswith("bml")
    assert "never" in ended.out
    assert not ended.out.endswith("\n\n")


def test_output_file_of_a_plan_is_checked_before_planning(kinesic, tmp_path: Path):
    (tmp_path / "old.npz").write_bytes(b"kept")
    for name in ("plan.doc", "old.npz"):
        ended = kinesic("plan", "missing.bml", "--out", name)
        assert ended.code == 2
        assert name in ended.err
        assert "missing.bml" not in ended.err
    assert (tmp_path / "old.npz").read_bytes() == b"kept"
