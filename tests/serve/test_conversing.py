"""Conversation of a client with the server's planner in simulated time."""

import json
from collections.abc import Callable

import numpy as np
import pytest

from kinesic.body.action_units import MAX_EYE_YAW
from kinesic.conversation.events import (
    Conversing,
    PeopleSeen,
    Person,
    Thinking,
    Transcript,
    VoiceActivity,
)
from kinesic.conversation.settings import MODE_BEARINGS
from kinesic.expressivity.gaze import towards
from kinesic.motion.trajectory import stay
from kinesic.planning.setup import Setup
from kinesic.serve.messages import ConversationRequest, FeedbackNotice, Halted, Proposal, Resumption
from kinesic.serve.tracks import FOLLOWED_FACE, SoundAndFace, TrackEffects

from .planning_bench import Planning

OWNER = 5
FRONT, LEFT = (1.5, 0.2, 1.4), (1.2, 1.4, 1.4)
SPEECH = '<speech id="s"><text>This is a rather long sentence, which I am telling you now.</text></speech>'


class Talk:
    """Planner in a conversation, and all messages to its client."""

    def __init__(self, planning: Planning) -> None:
        self.planning, self.told, self.proposals = planning, [], []

    @property
    def state(self):
        return self.planning.state

    @property
    def motion(self):
        return self.state._scene.motion

    def send(self, event, *, sender: int = OWNER, fills: bool = False, stops: int | None = None) -> "Talk":
        """Send an event after all emergency stops, or after the first `stops` only."""
        count = self.state._shared.stops if stops is None else stops
        self.state.execute(ConversationRequest(event, sender, count, fills))
        return self.collect()

    def collect(self) -> "Talk":
        for item in self.planning.loop.take():
            if isinstance(item, FeedbackNotice) and item.message.startswith("{"):
                self.told.append((self.planning.time, item.sender, json.loads(item.message)))
            elif isinstance(item, Proposal):
                self.proposals.append(item)
        return self

    def until(self, time: float, *people: Person, period: float = 0.2) -> "Talk":
        """Advance the planner, with periodic reports of people."""
        while self.planning.time < time - 1e-9:
            pause = self.state.pause
            self.planning.time = min(time, self.planning.time + min(period, np.inf if pause is None else pause))
            self.state.advance_scene()
            if people:
                self.send(PeopleSeen(people))
            self.collect()
        return self

    def states(self) -> list[str]:
        return [message["state"] for _, _, message in self.told if message["told"] == "conversing"]

    def head(self, time: float) -> float:
        """Return the head's yaw [deg] at a time, positive left."""
        robot = self.planning.setup.robot
        joints = [*robot.joints("torso"), *robot.joints("neck")]
        turned = [k for k in joints if robot.skeleton.names[k].endswith("torsion")]
        return float(np.degrees(self.motion.at(time).angles[turned].sum()))


@pytest.fixture
def talk(planning: Planning) -> Talk:
    return Talk(planning).send(Conversing(on=True))


def test_head_follows_a_person_and_returns_at_the_end_of_the_conversation(talk: Talk):
    goal = np.degrees(towards(np.array(LEFT), talk.planning.setup.robot).torsion)
    talk.until(2.0, Person("p", LEFT))
    assert talk.head(2.0) == pytest.approx(goal, abs=3.0)
    assert talk.states() == ["attending", "attending"]
    assert [message.get("who") for _, _, message in talk.told] == [None, "p"]
    assert {sender for _, sender, _ in talk.told} == {OWNER}
    talk.send(Conversing(on=False)).until(4.5)
    assert talk.states()[-1] == "off"
    assert talk.head(4.5) == pytest.approx(0.0, abs=0.01)


def test_head_starts_to_follow_a_person_within_a_quarter_of_a_second(talk: Talk):
    talk.until(1.0)
    talk.send(PeopleSeen((Person("p", LEFT),)))
    assert abs(talk.head(talk.planning.time + 0.25)) > 2.0


def test_repeated_report_of_a_person_at_the_same_place_causes_no_motion(talk: Talk):
    talk.until(1.0, Person("p", FRONT))
    motion = talk.motion
    talk.send(PeopleSeen((Person("p", FRONT),)))
    assert talk.motion.controls is motion.controls


def test_listening_robot_leans_and_nods_and_reports_its_nods_to_the_client(talk: Talk):
    talk.until(1.0, Person("p", FRONT))
    for k in range(6):
        talk.send(VoiceActivity(active=True, who="p")).until(2.5 + 2 * k, Person("p", FRONT))
        talk.send(VoiceActivity(active=False, who="p")).until(3.0 + 2 * k, Person("p", FRONT))
    assert talk.states()[-1] == "listening"
    signs = [message["sign"] for _, _, message in talk.told if message["told"] == "backchannel"]
    assert 2 <= len(signs) <= 6
    assert set(signs) == {"nod"}
    tilts = [k for k, name in enumerate(talk.planning.setup.robot.skeleton.names) if name.endswith(("tilt", "roll"))]
    assert np.degrees(np.abs(talk.motion.controls[-1] - talk.planning.setup.robot.skeleton.rest))[tilts].max() > 1.0


def test_speech_of_the_robot_starts_the_speaking_state_and_a_voice_interrupts_it(talk: Talk):
    talk.until(1.0, Person("p", FRONT))
    talk.planning.document("b", SPEECH)
    talk.until(2.5, Person("p", FRONT))
    assert talk.states()[-1] == "speaking"
    talk.send(VoiceActivity(active=True, who="p")).send(Transcript("wait a moment"))
    assert talk.states()[-1] == "interrupted"
    yielded = [message for _, sender, message in talk.told if message["told"] == "yielded" and sender == OWNER]
    assert yielded[0]["said"]
    assert "telling you now" in yielded[0]["unsaid"]
    assert not talk.state._scene.playing


def test_arms_perform_the_gesture_of_a_block_while_the_head_follows_a_person(talk: Talk, planning: Planning):
    talk.until(1.0, Person("p", FRONT))
    planning.document("b", '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND" stroke="2"/>')
    arms = list(planning.setup.robot.arm("l").all_joints)
    before = talk.collect().motion
    talk.until(2.0, Person("p", (1.5, -0.6, 1.4)))
    times = np.arange(2.0, 4.0, 0.05)
    assert talk.motion is not before
    np.testing.assert_allclose(talk.motion.angles(times)[:, arms], before.angles(times)[:, arms], atol=1e-9)


def test_filler_words_are_spoken_only_if_the_client_requests_them(make_planning: Callable[..., Planning]):
    for fills in (False, True):
        talk = Talk(make_planning()).send(Conversing(on=True), fills=fills)
        talk.until(1.0, Person("p", FRONT)).send(Thinking(on=True)).until(2.5, Person("p", FRONT))
        spoken = [item.utterance for running in talk.state._scene.blocks for item in running.speeches]
        assert bool(spoken) == fills
        assert talk.states()[-1] == "thinking"


def test_emergency_stop_ends_a_conversation_and_no_motion_follows(talk: Talk):
    talk.until(1.0, Person("p", LEFT))
    held = stay(talk.motion.at(1.0).angles, start=1.0)
    talk.state.handle_stop(Halted(1, 1.0, held))
    talk.collect()
    assert talk.states()[-1] == "off"
    talk.proposals.clear()
    talk.until(3.0)
    talk.send(PeopleSeen((Person("p", FRONT),)))
    motions = [proposal.motion for proposal in talk.proposals if proposal.motion is not None]
    assert all(np.ptp(motion.controls, axis=0).max() == 0.0 for motion in motions)
    np.testing.assert_array_equal(talk.motion.controls[-1], held.controls[-1])


@pytest.mark.parametrize("event", [Conversing(on=True), PeopleSeen((Person("p", FRONT),))])
def test_conversation_request_from_before_an_emergency_stop_moves_nothing(talk: Talk, event):
    talk.until(1.0, Person("p", LEFT))
    talk.state.handle_stop(Halted(1, 1.0, stay(talk.motion.at(1.0).angles, start=1.0)))
    talk.collect().proposals.clear()
    talk.send(event, stops=0).until(2.0)
    assert talk.states()[-1] == "off"
    assert [proposal for proposal in talk.proposals if proposal.motion is not None] == []
    talk.state.execute(Resumption(1))
    talk.send(Conversing(on=True))
    assert talk.states()[-1] == "attending"


def test_next_planner_turns_the_head_to_a_person_from_the_posture_of_the_previous_planner(
    talk: Talk, make_planning: Callable[..., Planning]
):
    goal = np.degrees(towards(np.array(LEFT), talk.planning.setup.robot).torsion)
    talk.until(3.0, Person("p", LEFT))
    heir = Talk(make_planning(motion=talk.motion)).send(Conversing(on=True))
    heir.until(2.0, Person("p", LEFT))
    assert heir.head(heir.motion.end) == pytest.approx(goal, abs=3.0)
    heir.send(Conversing(on=False)).until(6.0)
    assert heir.head(heir.motion.end) == pytest.approx(0.0, abs=0.01)


def test_idle_motion_continues_while_the_head_follows_a_person(make_planning: Callable[..., Planning], lively: Setup):
    talk = Talk(make_planning(lively)).send(Conversing(on=True))
    talk.until(4.0, Person("p", LEFT))
    assert talk.state._scene.idle is not None
    assert talk.proposals[-1].idles
    first = talk.state._scene.idle
    talk.until(16.0, Person("p", LEFT))
    assert talk.state._scene.idle is not first


def test_eyes_reach_a_person_before_the_head_and_stay_on_the_person(make_planning: Callable[..., Planning]):
    talk = Talk(make_planning(accompaniment=SoundAndFace(face=True))).send(Conversing(on=True)).until(1.0)
    effects = TrackEffects(face=True)
    talk.send(PeopleSeen((Person("p", FRONT),)))
    for proposal in talk.proposals:
        effects.take(proposal.tracks)
    goal = towards(np.array(FRONT), talk.planning.setup.robot).torsion
    begin = talk.planning.time
    for delay, is_turning in ((0.12, True), (2.0, False)):
        time = begin + delay
        face, head = effects.face(time), np.radians(talk.head(time))
        seen = head + (face["61"] - face["62"]) * MAX_EYE_YAW
        assert seen == pytest.approx(goal, abs=np.radians(0.6))
        assert (abs(goal - head) > np.radians(2.0)) == is_turning
    assert effects.face(begin + 60.0)["61"] == effects.face(begin + 10.0)["61"]


def test_robot_smiles_more_for_a_moment_when_it_greets_a_person(make_planning: Callable[..., Planning]):
    talk = Talk(make_planning(accompaniment=SoundAndFace(face=True))).send(Conversing(on=True))
    effects = TrackEffects(face=True)
    talk.until(0.2, Person("p", FRONT))
    for proposal in talk.proposals:
        effects.take(proposal.tracks)
    smiles = [effects.face(time).get("L12", 0.0) for time in (0.6, 1.6, 3.6)]
    held = dict(MODE_BEARINGS["attending"].face)["12"]
    assert smiles[0] > held + 0.1
    assert smiles[1:] == pytest.approx([held, held], abs=0.01)


def test_gaze_of_a_block_also_moves_the_eyes_during_a_conversation(make_planning: Callable[..., Planning]):
    talk = Talk(make_planning(accompaniment=SoundAndFace(face=True))).send(Conversing(on=True))
    talk.until(1.0, Person("p", FRONT))
    talk.planning.document(
        "b", '<gaze id="g" target="right" influence="EYES" start="0.2" ready="0.5" relax="3" end="3.3"/>'
    )
    talk.until(2.0, Person("p", FRONT))
    effects = TrackEffects(face=True)
    for proposal in talk.proposals:
        effects.take(proposal.tracks)
    assert effects.face(2.5)["62"] > 0.5
    talk.send(Conversing(on=False))
    assert talk.proposals[-1].tracks == {FOLLOWED_FACE: None}


def test_expression_of_a_state_fades_smoothly_into_that_of_the_next_state(make_planning: Callable[..., Planning]):
    talk = Talk(make_planning(accompaniment=SoundAndFace(face=True))).send(Conversing(on=True))
    effects = TrackEffects(face=True)
    talk.until(3.0, Person("p", FRONT)).send(Thinking(on=True))
    for proposal in talk.proposals:
        effects.take(proposal.tracks)
    faces = [effects.face(talk.planning.time + time) for time in np.arange(0.005, 1.2, 0.01)]
    for unit, mode, row in (("L12", "attending", 0), ("L4", "thinking", -1)):
        values = [face.get(unit, 0.0) for face in faces]
        assert values[row] == pytest.approx(dict(MODE_BEARINGS[mode].face)[unit[1:]], abs=0.01)
        assert values[-1 - row] == pytest.approx(0.0, abs=0.01)
        assert np.abs(np.diff(values)).max() < 0.03
