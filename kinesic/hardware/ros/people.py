"""Reports of people from ROS4HRI (REP 155) for a conversation."""

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

import numpy as np

from kinesic.hardware.ros.frames import FrameTree
from kinesic.hardware.ros.rosbridge import Message

PERSONS_TOPIC = "/humans/persons/tracked"  # ids of all persons whom ROS tracks
VOICES_TOPIC = "/humans/voices/tracked"  # ids of all voices
GAZE_TOPIC = "/humans/interactions/gazing"  # pairs of persons of whom one looks at the other
EXPRESSION_TOPIC = "/robot_face/expression"  # requested expression of the robot's face
TOPIC_TYPES: Mapping[str, str] = {
    PERSONS_TOPIC: "hri_msgs/msg/IdsList",
    VOICES_TOPIC: "hri_msgs/msg/IdsList",
    GAZE_TOPIC: "hri_msgs/msg/Gaze",
    EXPRESSION_TOPIC: "hri_msgs/msg/Expression",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
}
MEMBER_TYPES: Mapping[str, Mapping[str, str]] = {  # namespace -> topic of each member -> type
    "persons": {"voice_id": "std_msgs/msg/String"},
    "voices": {"is_speaking": "std_msgs/msg/Bool", "speech": "hri_msgs/msg/LiveSpeech"},
}
REPORT_PERIOD = 0.1  # [s] between two reports of people
GAZE_DURATION = 0.5  # [s] in which a reported gaze counts
MAX_PERSON_AGE = 1.0  # [s] since the position of a person was last reported
MAX_TRACKED = 32  # largest number of persons and of voices
MAX_DISTANCE = 50.0  # [m] farther persons are not reported
MAX_ID_LENGTH = 64  # [characters] longest id
MAX_TEXT_LENGTH = 2000  # [characters] longest forwarded text
FACE_LEXEMES: Mapping[str, str] = {  # expression of hri_msgs -> face lexeme
    **{name: name for name in ("neutral", "sad", "happy", "surprised", "disgusted", "scared", "embarrassed", "bored")},
    **dict.fromkeys(("angry", "furious", "annoyed"), "anger"),
    **dict.fromkeys(("pleading", "vulnerable"), "worry"),
    **dict.fromkeys(("despaired", "disappointed", "rejected"), "sadness"),
    **dict.fromkeys(("skeptical", "suspicious", "confused"), "doubt"),
    "guilty": "guilt",
    "horrified": "fear",
    "tired": "tired",
    "asleep": "close_eyes",
    "amazed": "surprise",
    "excited": "joy",
}


class Bridge(Protocol):
    """Connection to rosbridge."""

    def send(self, operation: str, **fields: object) -> None:
        """Send an operation."""

    def receive(self, timeout: float) -> Message | None:
        """Return the next operation, or None after a timeout [s]."""


class ConversationClient(Protocol):
    """Client of `kinesic serve`."""

    def send(self, bml: str) -> None:
        """Send a BML document."""

    def people(
        self, places: Mapping[str, tuple[float, float, float]], *, looking: Sequence[str] = (), age: float = 0.0
    ) -> None:
        """Report people by their positions [m]."""

    def heard(
        self, *, voice: bool | None = None, text: str | None = None, final: bool = False, who: str | None = None
    ) -> None:
        """Report a voice or recognised words."""


class PeopleBridge:
    """Forwards persons, voices, gazes and expressions from ROS to a robot's conversation."""

    def __init__(
        self,
        bridge: Bridge,
        robot: ConversationClient,
        *,
        base_frame: str = "base_link",
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        """Subscribe to the topics of ROS4HRI.

        Args:
            bridge: connection to ROS.
            robot: client that has begun a conversation.
            base_frame: frame of the robot's base: x forward, y left, z up.
            now: clock [s].
        """
        self._bridge, self._robot, self._base, self._now = bridge, robot, base_frame, now
        self._frames = FrameTree()
        self._tracked: dict[str, tuple[str, ...]] = {"persons": (), "voices": ()}
        self._persons: dict[str, str] = {}  # voice -> person
        self._speaking: set[str] = set()  # voices that sound
        self._gazes: dict[str, float] = {}  # person who looked at the robot -> clock time [s]
        self._reported = -REPORT_PERIOD  # [s] clock time of the last report
        self._documents = 0  # number of sent documents
        for topic, type_name in TOPIC_TYPES.items():
            bridge.send("subscribe", topic=topic, type=type_name)

    def step(self, timeout: float = REPORT_PERIOD) -> None:
        """Forward the next ROS message, and report people every `REPORT_PERIOD`.

        Raises:
            ConfigError: the connection to ROS has ended.
            OSError: the connection to the robot has ended.
        """
        operation = self._bridge.receive(timeout)
        if operation is not None and operation.get("op") == "publish":
            self._take(str(operation.get("topic")), operation.get("msg"))
        if self._now() - self._reported >= REPORT_PERIOD and self._tracked["persons"]:
            self._reported = self._now()
            self._report_people()

    def _take(self, topic: str, message: object) -> None:
        """Store or forward a message of a topic."""
        if not isinstance(message, dict):
            return
        match topic.split("/")[1:]:
            case ["tf"] | ["tf_static"]:
                self._frames.add(message, self._now())
            case ["humans", "persons" | "voices" as kind, "tracked"]:
                self._follow(kind, _ids(message))
            case ["humans", "persons", person, "voice_id"]:
                self._persons[str(message.get("data"))] = person
            case ["humans", "voices", voice, "is_speaking"]:
                self._hear_voice(voice, message.get("data") is True)
            case ["humans", "voices", voice, "speech"]:
                self._hear_words(voice, message)
            case ["humans", "interactions", "gazing"] if not message.get("receiver"):
                self._gazes[str(message.get("sender"))[:MAX_ID_LENGTH]] = self._now()
            case ["robot_face", "expression"]:
                self._show(str(message.get("expression")))

    def _follow(self, kind: str, members: tuple[str, ...]) -> None:
        """Update topic subscriptions for new and lost persons or voices."""
        before, self._tracked[kind] = self._tracked[kind], members
        for member in {*before} ^ {*members}:
            for name, type_name in MEMBER_TYPES[kind].items():
                topic = f"/humans/{kind}/{member}/{name}"
                if member in before:
                    self._bridge.send("unsubscribe", topic=topic)
                else:
                    self._bridge.send("subscribe", topic=topic, type=type_name)
        if kind == "voices":
            for voice in self._speaking - {*members}:
                self._hear_voice(voice, False)

    def _hear_voice(self, voice: str, sounds: bool) -> None:
        """Forward the beginning or the end of a voice."""
        if sounds != (voice in self._speaking):
            self._speaking ^= {voice}
            self._robot.heard(voice=sounds, who=self._persons.get(voice, voice))

    def _hear_words(self, voice: str, speech: Mapping[str, object]) -> None:
        """Forward recognised words, the final ones if there are any."""
        final, incremental = speech.get("final"), speech.get("incremental")
        text = final or incremental
        if isinstance(text, str) and text:
            self._robot.heard(text=text[:MAX_TEXT_LENGTH], final=bool(final), who=self._persons.get(voice, voice))

    def _show(self, expression: str) -> None:
        """Show an expression of hri_msgs until the next one."""
        lexeme = FACE_LEXEMES.get(expression)
        if lexeme is not None:
            self._documents += 1
            shift = f'<faceShift id="f" lexeme="{lexeme}" start="0"/>'
            name = f"ros-expression-{self._documents}"
            self._robot.send(f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{name}">{shift}</bml>')

    def _report_people(self) -> None:
        """Report all persons with a known and recent position."""
        places: dict[str, tuple[float, float, float]] = {}
        now = self._now()
        for person in self._tracked["persons"]:
            frame = f"person_{person}"
            position, age = self._frames.position(frame, self._base), self._frames.age(frame, now)
            if position is None or age is None or age > MAX_PERSON_AGE or np.max(np.abs(position)) > MAX_DISTANCE:
                continue
            x, y, z = position.tolist()
            places[person] = (x, y, z)
        self._gazes = {person: seen for person, seen in self._gazes.items() if now - seen <= GAZE_DURATION}
        self._robot.people(places, looking=tuple(self._gazes))


def _ids(message: Mapping[str, object]) -> tuple[str, ...]:
    """Return the valid ids of a hri_msgs/IdsList."""
    ids = message.get("ids")
    names = ids if isinstance(ids, list) else []
    valid = [name for name in names if isinstance(name, str) and name.replace("_", "").isalnum()]
    return tuple(dict.fromkeys(name for name in valid if len(name) <= MAX_ID_LENGTH))[:MAX_TRACKED]
