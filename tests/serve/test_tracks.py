import numpy as np
import pytest

from kinesic.body.utterance import Sound
from kinesic.realizer.realizer import Scene, begin, prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.serve.tracks import SoundAndFace, Track, TrackEffects, make_track, track_version
from kinesic.speech.loudspeaker import SpeakerError

BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<faceLexeme id="f" lexeme="RAISE_BROWS" amount="1" start="0" attackPeak="0.3" relax="0.6" end="0.9"/></bml>'
)


class Recorder:
    """Stub loudspeaker that records its calls."""

    def __init__(self, fault=None):
        self.told, self.fault = [], fault

    def play(self, sound, at):
        if self.fault:
            raise self.fault
        self.told.append(at)

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


def test_face_of_a_block_is_in_clock_time(running):
    one = make_track(running, SoundAndFace(face=True))
    brows = {time: one.at(running.zero + time).get("L1", 0.0) for time in (0.0, 0.3, 0.5, 0.89)}
    assert brows[0.0] < 0.1 < 0.5 < brows[0.3] == pytest.approx(brows[0.5], abs=0.05)
    assert brows[0.89] < 0.1
    assert one.at(running.zero - 1.0) == one.at(running.zero + 60.0) == {}


def test_tracks_without_outputs_are_not_computed(running):
    assert make_track(running, SoundAndFace()).face == {}
    assert track_version(running) == track_version(running)


def test_maximum_intensities_of_several_faces_are_shown():
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


def test_sounds_of_removed_blocks_stop_and_others_continue():
    speaker = Recorder()
    effects = TrackEffects(speaker)
    effects.take({"a": heard(1.0), "b": heard(2.0)})
    speaker.told.clear()
    effects.take({"a": None})
    assert speaker.told == ["stop", 2.0]
    effects.clear()
    assert speaker.told == ["stop", 2.0, "stop"]


def test_failing_loudspeaker_is_ignored():
    speaker = Recorder(SpeakerError("unplugged"))
    effects = TrackEffects(speaker, face=True)
    effects.take({"a": heard(1.0), "b": shows(0.0, x=[1.0])})
    speaker.fault = None
    effects.take({"c": heard(3.0)})
    assert speaker.told == []
    assert effects.face(0.0) == {"x": 1.0}
