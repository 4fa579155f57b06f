"""Previews of documents and locations of errors."""

from base64 import b64decode

import numpy as np
import pytest

from kinesic.bml.block import DEFAULT_BOUNDS
from kinesic.serve.desk.draft import draft
from kinesic.session.plan import plan

SPOKEN_DOCUMENT = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc">\n'
    '<speech id="s"><text>Say <sync id="m"/>one, and another.</text></speech>\n'
    '<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="s:m"/></bml>'
)


def test_document_preview_contains_word_times_strokes_and_joint_angles(upper22_setup):
    preview = draft(SPOKEN_DOCUMENT, (), upper22_setup, bounds=DEFAULT_BOUNDS, max_duration=60.0)
    assert [(item["mark"], item["text"]) for item in preview["words"]] == [("start", "Say"), ("m", "one, and another.")]
    assert preview["words"][0]["end"] == preview["words"][1]["start"]
    (stroke,) = [item for item in preview["syncs"] if item["behaviour"] == "g" and item["sync"] == "stroke"]
    assert stroke["asked"] == pytest.approx(preview["words"][1]["start"], abs=1e-3)
    hinges = len(upper22_setup.robot.skeleton.names)
    angles = np.frombuffer(b64decode(preview["angles"]), "<f4").reshape(-1, hinges)
    assert len(angles) == pytest.approx(preview["duration"] * preview["rate"], abs=2)
    assert np.allclose(angles[0], upper22_setup.robot.skeleton.rest, atol=1e-3)
    assert np.ptp(angles, axis=0).max() > 0.5
    assert preview["phonemes"] == sorted(preview["phonemes"], key=lambda each: each[1])


def test_document_preview_contains_the_speech_loudness_over_time(speaking_setup, upper22_setup):
    preview = draft(SPOKEN_DOCUMENT, (), speaking_setup, bounds=DEFAULT_BOUNDS, max_duration=60.0)
    peaks = np.frombuffer(b64decode(preview["loudness"]), np.uint8)
    assert peaks.max() == 255
    begin, end = preview["words"][0]["start"], preview["words"][-1]["end"]
    loud = np.flatnonzero(peaks > 25) / preview["rate"]
    assert begin - 0.05 <= loud[0] < begin + 0.3
    assert end - 0.4 < loud[-1] <= end + 0.1
    assert draft(SPOKEN_DOCUMENT, (), upper22_setup, bounds=DEFAULT_BOUNDS, max_duration=60.0)["loudness"] == "", (
        "nothing is heard"
    )


def test_document_preview_contains_each_warning_once(upper22_setup):
    odd = SPOKEN_DOCUMENT.replace('id="g"', 'id="g" colour="red"').replace('lexeme="offer"', 'lexeme="xyzzy"')
    notices = draft(odd, (), upper22_setup, bounds=DEFAULT_BOUNDS, max_duration=60.0)["notices"]
    texts = [(item["id"], item["text"]) for item in notices]
    assert [text for _, text in texts if "colour" in text or "xyzzy" in text] != []
    assert len(texts) == len(set(texts)) == 2


def test_document_preview_contains_the_outcome_of_each_behaviour_with_its_reason(upper22_setup):
    odd = SPOKEN_DOCUMENT.replace('lexeme="offer"', 'lexeme="xyzzy"').replace(
        "</bml>", '<gesture id="h" lexeme="offer"/></bml>'
    )
    behaviours = draft(odd, (), upper22_setup, bounds=DEFAULT_BOUNDS, max_duration=60.0)["behaviours"]
    planned = plan(odd, upper22_setup).keyframes.outcomes
    outcomes = {item["id"]: (item["outcome"], item["why"]) for item in behaviours}
    assert outcomes == {name: (planned[name].kind, planned[name].why) for name in ("s", "g", "h")}
    assert outcomes["s"] == outcomes["h"] == ("realised", "")
    assert outcomes["g"][0] != "realised"
    assert "xyzzy" in outcomes["g"][1]


def test_preview_of_an_invalid_document_reports_the_error_with_its_line(upper22_setup):
    wrong = draft(
        SPOKEN_DOCUMENT.replace("s:m", "none:end"), (), upper22_setup, bounds=DEFAULT_BOUNDS, max_duration=60.0
    )
    assert wrong["error"]["line"] == 3
    assert "none" in wrong["error"]["text"]
    assert draft("<bml", (), upper22_setup, bounds=DEFAULT_BOUNDS, max_duration=60.0)["error"]["line"] == 1
    assert (
        "at most 1 s"
        in draft(SPOKEN_DOCUMENT, (), upper22_setup, bounds=DEFAULT_BOUNDS, max_duration=1.0)["error"]["text"]
    )
    assert (
        "power"
        in draft(SPOKEN_DOCUMENT, ("powr=1",), upper22_setup, bounds=DEFAULT_BOUNDS, max_duration=9.0)["error"]["text"]
    )


def test_document_preview_reads_no_files_named_in_the_document(upper22_setup, tmp_path):
    (tmp_path / "a.wav").write_bytes(b"no sound")
    spoken = '<bml id="b"><speech id="s" start="0"><text>hi</text><description priority="1" type="audio/wav">{}'
    said = set()
    for name in (tmp_path / "a.wav", tmp_path / "gone.wav", tmp_path, "/etc/passwd"):
        document = spoken.format(f'<file ref="{name}"/></description></speech></bml>')
        preview = draft(document, (), upper22_setup, bounds=DEFAULT_BOUNDS, max_duration=60.0)
        said.update(item["text"].replace(str(name), "FILE") for item in preview["notices"])
    assert len(said) == 1, said
    assert "the document is not a file" in said.pop()


BODY_PARTS_DOCUMENT = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="doc">'
    '<speech id="s"><text>Say one, and another.</text></speech>'
    '<gesture id="left" lexeme="offer" mode="LEFT_HAND" start="0"/>'
    '<gesture id="both" lexeme="welcome" mode="BOTH_HANDS" start="3"/>'
    '<gesture id="odd" lexeme="xyzzy" mode="BOTH_HANDS" start="6"/>'
    '<head id="nod" lexeme="NOD" start="1"/><gaze id="look" target="left" start="1" end="3"/>'
    '<faceFacs id="lips" au="12" start="1" end="3"/><wait id="pause" duration="1"/>'
    '<posture id="lean" start="0" end="3"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture></bml>'
)


def test_document_preview_names_the_body_parts_and_lexeme_of_each_behaviour(upper22_setup):
    preview = draft(BODY_PARTS_DOCUMENT, (), upper22_setup, bounds=DEFAULT_BOUNDS, max_duration=60.0)
    assert {item["id"]: (item["label"], *item["tracks"]) for item in preview["behaviours"]} == {
        "s": ("Say one, and another.", "voice"),
        "left": ("offer", "l_hand"),
        "both": ("welcome", "r_hand", "l_hand"),
        "odd": ("xyzzy", "r_hand", "l_hand"),
        "nod": ("NOD", "head"),
        "look": ("left", "gaze"),
        "lips": ("AU 12", "face"),
        "pause": ("pause",),
        "lean": ("LEANING_FORWARD", "torso"),
    }


def test_document_preview_contains_accents_within_the_spoken_words(speaking_setup):
    preview = draft(SPOKEN_DOCUMENT, (), speaking_setup, bounds=DEFAULT_BOUNDS, max_duration=60.0)
    begin, end = preview["words"][0]["start"], preview["words"][-1]["end"]
    assert 2 <= len(preview["accents"]) <= 6
    assert preview["accents"] == sorted(preview["accents"])
    assert all(begin < time < end for time in preview["accents"])
