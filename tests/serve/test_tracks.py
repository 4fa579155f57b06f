from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.utterance import Sound
from kinesic.realizer.realizer import Scene, begin, prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.serve import tracks
from kinesic.serve.tracks import SoundAndFace, Track, TrackEffects, changed_tracks, make_track, track_version
from kinesic.speech.loudspeaker import SpeakerError

BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<faceLexeme id="f" lexeme="RAISE_BROWS" amount="1" start="0" attackPeak="0.3" relax="0.6" end="0.9"/></bml>'
)


class Recorder:
    """Stub loudspeaker that records its calls."""

    def __init__(self, fault=None):
        self.told, self.muted, self.fault = [], [], fault

    def play(self, sound, at):
        if self.fault:
            raise self.fault
        self.told.append(at)

    def fade_out(self, sound, at):
        self.told.append(("fades", at))

    def mute(self, *, on):
        self.muted.append(on)

    def stop(self):
        self.told.append("stop")


def heard(*begins):
    return Track(0.0, {}, tuple((begin, Sound.of(8000, np.zeros(8))) for begin in begins))


def shows(begin, **units):
    return Track(begin, {unit: np.array(values) for unit, values in units.items()}, ())


@pytest.fixture(scope="module")
def running(known):
    coming = prepare_block(read_request(Message(BLOCK.encode()), known), known)
    return begin(Scene.of(known), coming, 10.0).playing[0]


def test_facial_motion_of_a_block_is_timed_by_the_server_clock(running):
    one = make_track(running, SoundAndFace(face=True))
    brows = {time: one.at(running.zero + time).get("L1", 0.0) for time in (0.0, 0.3, 0.5, 0.89)}
    assert brows[0.0] < 0.1 < 0.5 < brows[0.3] == pytest.approx(brows[0.5], abs=0.05)
    assert brows[0.89] < 0.1
    assert one.at(running.zero - 1.0) == one.at(running.zero + 60.0) == {}


def test_face_track_is_empty_without_a_face_output(running):
    assert make_track(running, SoundAndFace()).face == {}
    assert track_version(running) == track_version(running)


def test_overlapping_face_tracks_show_the_maximum_intensity_of_an_action_unit():
    effects = TrackEffects(face=True)
    effects.take({"a": shows(1.0, x=[0.2, 0.8], y=[0.5, 0.5]), "b": shows(1.01, x=[0.4])})
    assert effects.face(1.0) == {"x": 0.2, "y": 0.5}
    assert effects.face(1.0101) == {"x": 0.8, "y": 0.5}
    effects.take({"a": None})
    assert effects.face(1.0101) == {"x": 0.4}
    effects.clear()
    assert effects.face(1.0101) == {}


def test_sound_that_was_played_is_not_played_again():
    speaker = Recorder()
    effects = TrackEffects(speaker)
    effects.take({"a": heard(1.0)})
    effects.take({"b": heard(2.0)})
    effects.take({"a": heard(1.0)})
    assert speaker.told == [1.0, 2.0]


def test_sounds_of_removed_blocks_fade_out_and_others_continue():
    speaker = Recorder()
    effects = TrackEffects(speaker)
    effects.take({"a": heard(1.0), "b": heard(2.0)})
    speaker.told.clear()
    effects.take({"a": None})
    assert speaker.told == [("fades", 1.0)]
    effects.clear()
    assert speaker.told == [("fades", 1.0), "stop"]


@pytest.mark.parametrize(("block", "faded"), [("a", [1.0]), (None, [1.0, 2.0]), ("x", [])])
def test_silenced_blocks_stay_silent_until_their_tracks_are_removed(block, faded):
    speaker = Recorder()
    effects = TrackEffects(speaker, face=True)
    effects.take({"a": heard(1.0), "b": heard(2.0)})
    speaker.told.clear()
    effects.silence(block)
    assert sorted(speaker.told) == [("fades", at) for at in faded]
    effects.take({"a": heard(1.5)})  # planned again before the interruption is planned
    assert (1.5 in speaker.told) == (1.0 not in faded)
    effects.take({"a": None, "b": None})
    effects.take({"a": heard(3.0)})
    assert speaker.told[-1] == 3.0


def test_sound_muted_for_a_speaking_person_is_unmuted_on_request_or_at_an_emergency_stop():
    speaker = Recorder()
    effects = TrackEffects(speaker)
    effects.duck(on=True)
    effects.duck(on=False)
    assert speaker.muted == [True, False]
    effects.clear()
    assert speaker.muted[2:] == [False]
    TrackEffects().duck(on=True)


def test_failed_loudspeaker_is_not_used_again_and_faces_continue():
    speaker = Recorder(SpeakerError("unplugged"))
    effects = TrackEffects(speaker, face=True)
    effects.take({"a": heard(1.0), "b": shows(0.0, x=[1.0])})
    speaker.fault = None
    effects.take({"c": heard(3.0)})
    assert speaker.told == []
    assert effects.face(0.0) == {"x": 1.0}


def test_face_track_has_a_row_per_10_ms():
    track = shows(1.0, x=[0.25, 0.5])
    assert [track.at(time) for time in (0.985, 1.0, 1.0101, 1.0201)] == [{}, {"x": 0.25}, {"x": 0.5}, {}]


@pytest.mark.parametrize("needs", [False, True])
@pytest.mark.parametrize("amount", [0.0, 0.5])
@pytest.mark.parametrize("outputs", [SoundAndFace(), SoundAndFace(face=True), SoundAndFace(sound=True)])
def test_track_of_a_block_contains_its_speech_sounds_and_a_moving_or_idle_face(monkeypatch, needs, amount, outputs):
    asked = []
    monkeypatch.setattr(tracks, "needs_face", lambda plan: needs)
    monkeypatch.setattr(tracks, "compute_action_units", lambda plan, times: asked.append(times) or {"x": times})
    setup = SimpleNamespace(idling=SimpleNamespace(amount=amount))
    plan = SimpleNamespace(trajectory=SimpleNamespace(zero=0.25), duration=0.035, setup=setup)
    sound = Sound.of(8000, np.zeros(8))
    speeches = [
        SimpleNamespace(begin=begin, utterance=SimpleNamespace(sound=of)) for begin, of in ((11.0, sound), (12.0, None))
    ]
    track = make_track(SimpleNamespace(prepared=SimpleNamespace(plan=plan), zero=10.0, speeches=speeches), outputs)
    assert track.begin == 9.75
    assert track.sounds == (((11.0, sound),) if outputs.sound else ())
    shows_face = outputs.face and (needs or amount > 0.0)
    assert list(track.face) == ["x"] * shows_face
    assert [times.tolist() for times in asked] == [pytest.approx([0.0, 0.01, 0.02, 0.03])] * shows_face


def test_only_changed_face_tracks_are_computed_and_ended_ones_removed(monkeypatch):
    monkeypatch.setattr(tracks, "make_track", lambda running, outputs: (running.id, outputs))

    def block(name, zero, end=5.0, times=()):
        return SimpleNamespace(id=name, zero=zero, end=end, times=times, prepared=SimpleNamespace(plan="plan"))

    outputs = SoundAndFace(sound=True)
    scene = SimpleNamespace(
        idle=None, followed_face=None, foreign_sound=None, playing=[block("a", 1.0), block("b", 2.0)]
    )
    versions, changes = changed_tracks(scene, {}, outputs)
    assert changes == {"a": ("a", outputs), "b": ("b", outputs)}
    assert changed_tracks(scene, versions, outputs) == (versions, {})
    for changed in (block("b", 2.5), block("b", 2.0, end=6.0), block("b", 2.0, times=("s",))):
        later = SimpleNamespace(idle=block("idle", 0.0), foreign_sound=None, playing=[changed])
        found, changes = changed_tracks(later, versions, outputs)
        assert list(found) == ["idle", "b"]
        assert changes == {"a": None, "idle": ("idle", outputs), "b": ("b", outputs)}
    assert changed_tracks(scene, versions, SoundAndFace()) == ({}, {})
    assert changed_tracks(scene, versions, SoundAndFace(face=True))[0] == versions


def test_server_computes_face_and_sound_only_if_it_has_outputs_for_them():
    assert TrackEffects().accompaniment == SoundAndFace(face=False, sound=False)
    assert TrackEffects(Recorder(), face=True).accompaniment == SoundAndFace(face=True, sound=True)
