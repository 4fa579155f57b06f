"""Translation of ROS4HRI messages into reports of a conversation, with fakes of both connections."""

from collections import deque

import pytest

from kinesic.bml.actions import Face
from kinesic.client import Client
from kinesic.expressivity.face.expressions import find_expression
from kinesic.hardware.ros.people import FACE_LEXEMES, PeopleBridge

from .test_frames import transform


class Ros:
    """Bridge that delivers prepared messages and records operations."""

    def __init__(self) -> None:
        self.messages: deque[dict] = deque()
        self.operations: list[tuple[str, str]] = []

    def send(self, operation: str, **fields: object) -> None:
        self.operations.append((operation, str(fields["topic"])))

    def receive(self, timeout: float) -> dict | None:
        return self.messages.popleft() if self.messages else None


class Recorder(Client):
    """Client that records control messages instead of sending them."""

    def __init__(self) -> None:
        self.messages: list[dict] = []
        self.documents: list[str] = []

    def do(self, verb: str, **values: object) -> None:
        self.messages.append({"do": verb} | values)

    def send(self, bml: str) -> None:
        self.documents.append(bml)


class Scene:
    """People in front of a robot."""

    def __init__(self) -> None:
        self.ros, self.robot, self.time = Ros(), Recorder(), 10.0
        self.bridge = PeopleBridge(self.ros, self.robot, now=lambda: self.time)

    def publish(self, topic: str, message: object) -> list[dict]:
        """Deliver a message, and return the control messages that follow."""
        self.robot.messages.clear()
        self.ros.messages.append({"op": "publish", "topic": topic, "msg": message})
        self.bridge.step()
        self.time += 0.1
        return self.robot.messages


@pytest.fixture
def scene() -> Scene:
    return Scene()


def heard(**values: object) -> dict:
    return {"do": "heard", "voice": None, "text": None, "final": False, "who": None, "age": 0.0} | values


def test_topics_of_a_voice_are_subscribed_while_it_is_tracked(scene: Scene):
    scene.publish("/humans/voices/tracked", {"ids": ["v1", "v2"]})
    scene.ros.operations.clear()
    scene.publish("/humans/voices/tracked", {"ids": ["v2", "v3"]})
    assert sorted(scene.ros.operations) == [
        ("subscribe", "/humans/voices/v3/is_speaking"),
        ("subscribe", "/humans/voices/v3/speech"),
        ("unsubscribe", "/humans/voices/v1/is_speaking"),
        ("unsubscribe", "/humans/voices/v1/speech"),
    ]


def test_voice_is_reported_only_when_it_begins_and_ends(scene: Scene):
    topic = "/humans/voices/v1/is_speaking"
    reports = [list(scene.publish(topic, {"data": sounds})) for sounds in (False, True, True, False)]
    assert reports == [[], [heard(voice=True, who="v1")], [], [heard(voice=False, who="v1")]]


def test_voice_that_is_lost_while_it_sounds_ends(scene: Scene):
    scene.publish("/humans/voices/tracked", {"ids": ["v1"]})
    scene.publish("/humans/voices/v1/is_speaking", {"data": True})
    assert scene.publish("/humans/voices/tracked", {"ids": []}) == [heard(voice=False, who="v1")]


def test_final_words_replace_incremental_ones(scene: Scene):
    topic = "/humans/voices/v1/speech"
    assert scene.publish(topic, {"incremental": "so I", "final": ""}) == [heard(text="so I", who="v1")]
    final = scene.publish(topic, {"incremental": "so I", "final": "so I go", "confidence": 0.9})
    assert final == [heard(text="so I go", final=True, who="v1")]
    assert scene.publish(topic, {"incremental": "", "final": ""}) == []


def test_voice_of_a_matched_person_has_the_id_of_the_person(scene: Scene):
    scene.publish("/humans/persons/p1/voice_id", {"data": "v1"})
    assert scene.publish("/humans/voices/v1/is_speaking", {"data": True}) == [heard(voice=True, who="p1")]


def test_persons_are_reported_with_place_and_gaze_ten_times_a_second(scene: Scene):
    scene.publish("/tf", transform("person_p1", "camera", (1.0, 0.2, 0.0)))
    scene.publish("/tf_static", transform("camera", "base_link", (0.0, 0.0, 1.5)))
    scene.publish("/humans/interactions/gazing", {"sender": "p1", "receiver": ""})
    (report,) = scene.publish("/humans/persons/tracked", {"ids": ["p1", "p2"]})
    assert report == {"do": "people", "people": [{"id": "p1", "at": (1.0, 0.2, 1.5), "looks": True}], "age": 0.0}
    scene.time -= 0.05
    assert scene.publish("/tf", {}) == []


def test_gaze_at_another_person_is_no_gaze_at_the_robot_and_an_old_gaze_has_ended(scene: Scene):
    scene.publish("/tf", transform("person_p1", "base_link", (1.0, 0.0, 0.0)))
    scene.publish("/humans/interactions/gazing", {"sender": "p1", "receiver": "p2"})
    (report,) = scene.publish("/humans/persons/tracked", {"ids": ["p1"]})
    assert report["people"][0]["looks"] is False
    scene.publish("/humans/interactions/gazing", {"sender": "p1", "receiver": ""})
    scene.time += 0.5
    assert scene.publish("/tf", {})[0]["people"][0]["looks"] is False


@pytest.mark.parametrize(("place", "wait"), [((1.0, 0.0, 0.0), 1.0), ((51.0, 0.0, 0.0), 0.0)])
def test_person_whose_place_is_old_or_too_far_is_not_reported(scene: Scene, place: tuple[float, ...], wait: float):
    scene.publish("/tf", transform("person_p1", "base_link", place))
    scene.time += wait
    assert scene.publish("/humans/persons/tracked", {"ids": ["p1"]}) == [{"do": "people", "people": [], "age": 0.0}]


def test_requested_expressions_become_faces_that_stay(scene: Scene):
    scene.publish("/robot_face/expression", {"expression": "furious"})
    scene.publish("/robot_face/expression", {"expression": "unknown"})
    scene.publish("/robot_face/expression", {"expression": "neutral"})
    first, second = scene.robot.documents
    assert '<faceShift id="f" lexeme="anger" start="0"/>' in first
    assert 'id="ros-expression-2"' in second


def test_each_expression_of_hri_msgs_has_a_known_face():
    assert len(FACE_LEXEMES) == 25
    faces = {name: find_expression(Face((lexeme,))) for name, lexeme in FACE_LEXEMES.items()}
    assert [name for name, face in faces.items() if face.unknown or face.left_out] == []
    assert [name for name, face in faces.items() if not face.units] == ["neutral"]


@pytest.mark.parametrize("name", ["a/b", "..", "", "a b", "x" * 65, 3, None])
def test_invalid_ids_never_become_topics(scene: Scene, name: object):
    scene.ros.operations.clear()
    scene.publish("/humans/voices/tracked", {"ids": [name]})
    scene.publish("/humans/voices/tracked", {"ids": "ab"})
    scene.publish("/humans/voices/tracked", None)
    assert scene.ros.operations == []
