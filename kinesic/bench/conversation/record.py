"""Performance of a scripted dialogue in virtual time, with a record."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import inf

import numpy as np

from kinesic.bench.conversation.dialogues import STANDING_PLACE, Dialogue
from kinesic.conversation.events import ConversationEvent, Conversing
from kinesic.conversation.settings import TURN_TIMES
from kinesic.conversation.wants import Yield
from kinesic.expressivity.gaze import towards
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.setup import Setup
from kinesic.planning.torso import compute_torso_turn
from kinesic.realizer.realizer import Scene
from kinesic.serve.conversing import Conversation
from kinesic.serve.messages import ConversationRequest

COMMAND_DELAY = 0.03  # [s] time between a decision and the first changed command
SETTLING_TIME = 1.0  # [s] time after which the head has reached a standing person
MAX_SIDE_DISTANCE = 0.1  # [m] largest sideways distance between gaze target and person for a look at the person


@dataclass(eq=False)
class DialogueRecord:
    """Decisions and motion of one dialogue."""

    modes: list[tuple[float, str]] = field(default_factory=list)  # time [s] and name of each new mode
    looks: list[tuple[float, bool]] = field(default_factory=list)  # time [s], and whether the gaze meets a person
    yields: list[float] = field(default_factory=list)  # [s] times at which the robot yields
    nods: int = 0  # number of nods
    motions: list[Trajectory] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)  # [deg] azimuth errors of the head towards the standing person
    thinking_delay: float = TURN_TIMES.end_to_thinking  # [s] delay from the end of a turn to the thinking state

    def looking_fraction(self, begin: float, end: float) -> float:
        """Return the fraction of a time span spent looking at a person."""
        met = next((value for time, value in reversed(self.looks) if time <= begin), False)
        total, last = 0.0, begin
        for time, value in self.looks:
            if begin < time < end:
                total, last, met = total + met * (time - last), time, value
        return (total + met * (end - last)) / (end - begin)

    @property
    def longest_look(self) -> float:
        """Longest look at a person without a look away [s]."""
        longest, since = 0.0, inf
        for time, value in self.looks:
            if value:
                since = min(since, time)
            else:
                longest, since = max(longest, time - since), inf
        return longest


@dataclass(eq=False)
class VirtualScene:
    """Scene that accepts each change at a virtual time."""

    scene: Scene
    now: float = 0.0  # [s] virtual time
    messages: list[str] = field(default_factory=list)

    def propose(self, change: Callable[[Scene, float], Scene]) -> None:
        """Apply a change of the scene at the present virtual time."""
        self.scene = change(replace(self.scene, ahead=COMMAND_DELAY, outgoing_feedback=()), self.now)

    def tell(self, message: str, client: int) -> None:
        """Record a message to the client."""
        self.messages.append(message)


def perform_dialogue(dialogue: Dialogue, setup: Setup) -> DialogueRecord:
    """Perform a dialogue, and return its decisions and motion."""
    shared, done = VirtualScene(Scene.of(setup)), DialogueRecord()
    conversation = Conversation(shared, shows_eyes=False)
    queue: list[tuple[float, ConversationEvent]] = [(0.0, Conversing(on=True)), *dialogue.events]
    position = 0
    while True:
        due = conversation.next_time(shared.now)
        event = queue[position] if position < len(queue) and queue[position][0] <= due else None
        before, shared.now = conversation.look, due if event is None else event[0]
        if shared.now > dialogue.end:
            return done
        motion, since = shared.scene.motion, done.looks[-1][0] if done.looks else inf
        if event is None:
            wants = conversation.advance(shared.now)
        else:
            wants, position = conversation.take(ConversationRequest(event[1], 0), shared.now), position + 1
        done.yields += [shared.now for want in wants if isinstance(want, Yield)]
        if conversation.look is not before:
            if before.place is not None and before.away == (0.0, 0.0) and shared.now - since > SETTLING_TIME:
                done.errors += _error(motion, shared.now, before.place, setup)
            done.looks.append((shared.now, conversation.look.place is not None and conversation.look.away == (0, 0)))
        if shared.scene.motion is not motion:
            done.motions.append(shared.scene.motion)
        for message in map(json.loads, shared.messages):
            done.nods += message["told"] == "backchannel"
            if message["told"] == "conversing" and (not done.modes or done.modes[-1][1] != message["state"]):
                done.modes.append((shared.now, message["state"]))
        shared.messages.clear()


def _error(motion: Trajectory, time: float, place: tuple[float, float, float], setup: Setup) -> list[float]:
    """Return the head's azimuth error [deg] towards the standing person.

    The list is empty for a look at somebody else.
    """
    if abs(place[1] - STANDING_PLACE[1]) > MAX_SIDE_DISTANCE:
        return []
    angles, goal = motion.at(time).angles, towards(np.array(STANDING_PLACE), setup.robot)
    turn = sum((compute_torso_turn(setup.robot, chain, angles) for chain in ("torso", "neck")), np.zeros(3))
    return [float(np.degrees(abs(turn[0] - goal.torsion)))]
