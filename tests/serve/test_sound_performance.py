"""Speech sound of a client, performed by the server's planner in simulated time."""

from collections.abc import Callable

import numpy as np
import pytest

from kinesic.conversation.events import Conversing, PeopleSeen, Person, SoundPiece, SoundPosition, VoiceActivity
from kinesic.motion.trajectory import stay
from kinesic.serve.foreign_voice import START_DELAY
from kinesic.serve.messages import Halted, Interruption, Proposal, Resumption
from kinesic.serve.tracks import FOREIGN_SOUND, SoundAndFace, TrackEffects

from .planning_bench import Planning
from .test_conversing import FRONT, OWNER, Talk
from .test_foreign_voice import RATE, SYLLABLES, syllables


@pytest.fixture
def talk(make_planning: Callable[..., Planning]) -> Talk:
    made = Talk(make_planning(accompaniment=SoundAndFace(face=True, sound=True))).send(Conversing(on=True))
    return made.until(1.0, Person("p", FRONT))


def stream(talk: Talk, *, ends: bool = True) -> float:
    """Send a sound in parts of half a second, and return its start."""
    data, begin, size = syllables(), talk.planning.time + START_DELAY, RATE
    for first in range(0, len(data), size):
        is_last = first + size >= len(data)
        talk.send(SoundPiece("a", RATE, data[first : first + size], ends=ends and is_last))
    return begin


def states(talk: Talk) -> list[str]:
    return [state for k, state in enumerate(talk.states()) if k == 0 or talk.states()[k - 1] != state]


def test_robot_is_in_the_speaking_state_for_as_long_as_the_sound_lasts(talk: Talk):
    begin = stream(talk)
    talk.until(begin + 0.1)
    assert states(talk)[-1] == "speaking"
    talk.until(begin + 4.9)
    assert states(talk)[-1] == "speaking"
    talk.until(begin + 5.2, Person("p", FRONT))
    assert states(talk)[-1] == "attending"
    assert talk.state._scene.foreign_sound is None


def test_loop_gets_the_mouth_and_all_parts_of_the_sound(talk: Talk):
    begin = stream(talk)
    effects = TrackEffects(face=True)
    for proposal in talk.proposals:
        effects.take(proposal.tracks)
    track = effects._tracks[FOREIGN_SOUND]
    assert track.sounds[0][0] == pytest.approx(begin)
    assert sum(sound.duration for _, sound in track.sounds) == pytest.approx(5.0, abs=0.01)
    assert effects.face(begin + SYLLABLES[1])["26"] > 0.3
    assert effects.face(begin + SYLLABLES[1] + 0.4).get("26", 0.0) < 0.05


def test_head_nods_at_stressed_syllables(talk: Talk):
    begin = stream(talk)
    talk.until(begin + 5.0)
    robot = talk.planning.setup.robot
    tilts = [k for k in robot.joints("neck") if robot.skeleton.names[k].endswith("tilt")]
    pitch = [np.degrees(talk.motion.at(begin + time).angles[tilts].sum()) for time in SYLLABLES[1:-1]]
    between = [np.degrees(talk.motion.at(begin + time + 0.4).angles[tilts].sum()) for time in SYLLABLES[1:-1]]
    assert np.mean(np.abs(np.subtract(pitch, between))) > 1.0


def test_hands_beat_at_stressed_syllables_of_waiting_sound(talk: Talk):
    begin = stream(talk)
    strokes = []
    while talk.planning.time < begin + 5.0:
        talk.until(talk.planning.time + 0.2)
        for block in talk.state._scene.blocks:
            time = block.zero + block.times["g"]["stroke"]
            strokes += [] if any(abs(time - other) < 0.2 for other in strokes) else [time]
    assert len(strokes) >= 2
    for stroke in strokes:
        assert min(abs(stroke - begin - time) for time in SYLLABLES) < 0.12


def test_person_who_interrupts_a_sound_learns_its_position_and_later_parts_are_ignored(talk: Talk):
    begin = stream(talk, ends=False)
    talk.until(begin + 1.5)
    talk.state.execute(Interruption(None, yields=True, silenced=talk.planning.time, sender=OWNER))
    yielded = [message for _, _, message in talk.collect().told if "sound" in message]
    assert yielded == [{"told": "yielded", "sound": "a", "at": pytest.approx(1.5, abs=0.01)}]
    assert talk.proposals[-1].tracks[FOREIGN_SOUND] is None
    talk.send(SoundPiece("a", RATE, syllables(0.5)))
    assert talk.state._scene.foreign_sound is None
    talk.send(SoundPiece("b", RATE, syllables(0.5)))
    assert talk.state._scene.foreign_sound.id == "b"


def test_voice_of_a_person_interrupts_a_sound(talk: Talk):
    begin = stream(talk)
    talk.until(begin + 1.0)
    talk.send(VoiceActivity(active=True, who="p")).until(begin + 2.0)
    assert states(talk)[-2:] == ["speaking", "interrupted"] or "interrupted" in states(talk)
    assert talk.state._scene.foreign_sound is None


def test_sound_without_a_conversation_is_refused(make_planning: Callable[..., Planning]):
    talk = Talk(make_planning()).send(SoundPiece("a", RATE, b""))
    assert talk.told[-1][2]["told"] == "refused"
    assert "converse" in talk.told[-1][2]["why"]


def test_sound_with_a_changing_rate_is_refused_and_the_rest_goes_on(talk: Talk):
    stream(talk, ends=False)
    talk.send(SoundPiece("a", 8000, b""))
    assert talk.told[-1][2] == {
        "told": "refused",
        "do": "sound",
        "why": "rate 8000 Hz after 24000 Hz; a sound has one rate",
    }
    assert talk.state._scene.foreign_sound.duration == pytest.approx(5.0, abs=0.01)


def test_position_of_a_sound_that_the_client_plays_moves_its_mouth(talk: Talk):
    talk.send(SoundPiece("a", RATE, syllables(), plays=False))
    talk.until(1.5).send(SoundPosition("a", 0.2)).send(SoundPosition("other", 0.9))
    assert talk.state._scene.foreign_sound.begin == pytest.approx(1.3)


def test_end_of_a_conversation_ends_its_sound(talk: Talk):
    stream(talk)
    talk.send(Conversing(on=False)).send(PeopleSeen(()))
    assert talk.state._scene.foreign_sound is None
    assert any(isinstance(item, Proposal) for item in talk.proposals)


def test_first_emergency_stop_ends_a_sound_and_a_conversation_that_may_begin_again_after_resume(talk: Talk):
    begin = stream(talk, ends=False)
    talk.until(begin + 1.0)
    held = stay(talk.motion.at(talk.planning.time).angles, start=talk.planning.time)
    talk.state.handle_stop(Halted(1, talk.planning.time, held))
    assert talk.collect().states()[-1] == "off"
    assert talk.state._scene.foreign_sound is None
    assert talk.proposals[-1].tracks[FOREIGN_SOUND] is None
    talk.send(SoundPiece("a", RATE, syllables(0.5)))
    assert talk.state._scene.foreign_sound is None, "the conversation has ended"
    talk.state.execute(Resumption(1))
    talk.send(Conversing(on=True)).until(talk.planning.time + 1.0, Person("p", FRONT))
    talk.send(SoundPiece("b", RATE, syllables(0.5)))
    assert talk.state._scene.foreign_sound.id == "b"


def test_new_planner_after_a_crash_converses_when_a_client_begins_again(
    make_planning: Callable[..., Planning], talk: Talk
):
    stream(talk)
    fresh = Talk(make_planning(accompaniment=SoundAndFace(face=True, sound=True)))
    fresh.send(SoundPiece("a", RATE, syllables(0.5)))
    assert fresh.told[-1][2]["told"] == "refused"
    fresh.send(Conversing(on=True)).send(SoundPiece("a", RATE, syllables(0.5))).until(1.0)
    assert states(fresh)[-1] == "speaking"
