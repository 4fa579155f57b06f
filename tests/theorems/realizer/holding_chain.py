"""Plays chains of blocks that hold a posture, and finds where each of them ends alone."""

from dataclasses import replace
from functools import cache

import numpy as np

from kinesic.bml.block import Behaviour
from kinesic.bml.composition import BlockState
from kinesic.bml.parse import parse
from kinesic.body.arrays import Floats
from kinesic.controller.perform import set_up
from kinesic.expressivity.behaviours import stays
from kinesic.motion.limit_check import check_limits
from kinesic.planning.plan import plan_block
from kinesic.planning.setup import Setup
from kinesic.realizer.ending import leave_out
from kinesic.realizer.realizer import (
    PreparedBlock,
    Scene,
    advance,
    begin,
    change_manner,
    improve_block,
    interrupt,
    prepare_block,
    take_replans,
)
from kinesic.realizer.request import Message, read_request

TEXT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
LOOKS = (
    '<gazeShift id="l" target="left"/>',
    '<gazeShift id="l" target="right"/>',
    '<gazeShift id="l" target="audience"/>',
    '<gazeShift id="l" target="1 0.4 0.9" start="0" end="1.4"/>',
    '<gazeShift id="l" target="1 -0.6 0.2" influence="WAIST"/>',
    '<gazeShift id="l" target="1 0.9 0.7" start="1.5"/>',
    '<headDirectionShift id="l" target="right"/>',
    '<headDirectionShift id="l" target="down"/>',
)
_POSTURE = '<postureShift id="p"><pose part="{}" lexeme="{}"/></postureShift>'
STANCES = (
    _POSTURE.format("WHOLEBODY", "LEANING_FORWARD"),
    _POSTURE.format("BODY", "LEANING_BACKWARD"),
    _POSTURE.format("BODY", "lean left"),
    _POSTURE.format("BODY", "upright"),
    _POSTURE.format("HEAD", "down"),
)
HOLDING = (
    LOOKS[0] + STANCES[0],
    LOOKS[1] + STANCES[3],
    '<gazeShift id="k" target="right" start="0"/><gazeShift id="l" target="left" start="1.6"/>',
    LOOKS[0] + '<head id="n" lexeme="NOD" start="0.2"/><gesture id="g" lexeme="beat" start="2"/>',
    '<wait id="w" duration="6"/>' + LOOKS[1],
)
PASSING = (
    '<head id="n" lexeme="NOD" repetition="2"/>',
    '<head id="n" lexeme="SHAKE"/>',
    '<gaze id="z" target="right" start="0" end="2"/>',
    '<gaze id="z" target="left" start="0.5" end="3"/><head id="n" lexeme="NOD" start="1"/>',
    '<gesture id="g" lexeme="beat" mode="RIGHT_HAND"/>',
    '<gesture id="g" lexeme="large" mode="BOTH_HANDS"/>',
    '<torso id="t" lexeme="lean" amount="1" start="0" end="2"/>',
    '<posture id="t" start="0" end="3"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture>',
)
STYLES = ("joyful", "sad", "neutral")
STEP = 0.05  # [s] of the clock
_ALONE: dict[str, Floats] = {}  # action -> held_alone
END_WARNING = "where it would end alone"  # words of the warning about an end that cannot be reached


@cache
def setup_once() -> Setup:
    """Load the default robot and style once."""
    return set_up()


@cache
def prepared(inside: str, id: str = "b") -> PreparedBlock:
    """Plan a block."""
    setup = setup_once()
    return prepare_block(read_request(Message(TEXT.format(id, inside)), setup), setup)


def trunk() -> list[int]:
    """List the hinges of torso and neck."""
    robot = setup_once().robot
    return [*robot.joints("torso"), *robot.joints("neck")]


@cache
def held_alone(inside: str) -> Floats:
    """Return how far torso and neck are from rest (k,) [rad] after a block alone."""
    controls = prepared(inside).plan.trajectory.controls
    return (controls[-1] - setup_once().robot.skeleton.rest)[trunk()]


class Chain:
    """A scene to which block after block is sent, in virtual time."""

    def __init__(self, *, ahead: float) -> None:
        self.scene, self.now = Scene.of(setup_once(), ahead=ahead), 0.0
        self.warnings: list[str] = []
        self.limit_ratio = 0.0  # largest of any limit, of all motions
        self._held: dict[tuple[str, str], tuple[str, float, Floats]] = {}  # block, behaviour -> kind, end [s], held
        self._over: set[str] = set()
        self._sent = 0

    def wait(self, seconds: float) -> "Chain":
        """Let time pass."""
        until = self.now + seconds
        while self.now < until - 1e-9:
            self.now = min(until, self.now + STEP)
            self._take(advance(self.scene, self.now))
        return self

    def send(self, inside: str) -> "Chain":
        """Send a block under the next id."""
        self._sent += 1
        return self._take(begin(self.scene, prepared(inside, f"b{self._sent}"), self.now))

    def do(self, deed: str, choice: int) -> "Chain":
        """Interrupt a block, one of its behaviours, or perform it in another style."""
        playing = [each for each in self.scene.playing if each.merged is not None and each.times]
        if not playing:
            return self
        running = playing[choice % len(playing)]
        if deed == "interrupt":
            return self._take(interrupt(self.scene, self.now, running.id))
        if deed == "leave out":
            gone = sorted(running.times)[choice % len(running.times)]
            return self._take(leave_out(self.scene, running, frozenset({gone}), self.now))
        style = STYLES[choice % len(STYLES)]
        scene, replans = take_replans(change_manner(self.scene, self.now, style=style, block=running.id))
        self._take(scene)
        for request in replans:
            better = prepare_block(request, scene.setup).plan
            self._take(improve_block(replace(self.scene, said=()), request.block.id, better, self.now) or self.scene)
        return self

    def finish(self) -> None:
        """Let everything end."""
        self.wait(40.0)

    @property
    def end(self) -> Floats:
        """Angles of torso and neck (k,) [rad] from rest, at the end of the motion."""
        rest = setup_once().robot.skeleton.rest
        return np.asarray((self.scene.motion.controls[-1] - rest)[trunk()])

    @property
    def expected_end(self) -> Floats:
        """Angles (k,) [rad] from rest that the last look and the last posture hold alone, within the limits."""
        last: dict[str, tuple[float, Floats]] = {}
        for kind, end, held in self._held.values():
            if end >= last.get(kind, (-np.inf, held))[0]:
                last[kind] = (end, held)
        skeleton, hinges = setup_once().robot.skeleton, trunk()
        rest = skeleton.rest[hinges]
        total = rest + sum((held for _, held in last.values()), np.zeros(len(hinges)))
        return np.asarray(np.clip(total, skeleton.lower[hinges], skeleton.upper[hinges]) - rest)

    @property
    def is_warned_of_its_end(self) -> bool:
        """Whether a warning says that something ends elsewhere."""
        return any(END_WARNING in text for text in self.warnings)

    def _take(self, scene: Scene) -> "Chain":
        if scene.motion is not self.scene.motion:
            peaks = check_limits(scene.motion, setup_once().limits).shares.values()
            self.limit_ratio = max(self.limit_ratio, *(float(peak.ratios.max()) for peak in peaks))
        self.warnings += [message.xml for message in scene.said if "<warningFeedback" in message.xml]
        self.scene = scene
        ended = {past.id for past in scene.ended if past.state is not BlockState.DONE}
        self._held = {key: held for key, held in self._held.items() if key[0] not in ended}
        for running in scene.playing:
            left_out = {key for key in self._held if key[0] == running.id and key[1] not in running.times}
            self._held = {key: held for key, held in self._held.items() if key not in left_out}
            for behaviour in running.block.behaviours:
                if stays(behaviour.action) and behaviour.id in running.times:
                    kind = "posture" if behaviour.type.startswith("posture") else "look"
                    end = running.zero + running.times[behaviour.id]["end"]
                    self._held[running.id, behaviour.id] = (kind, end, _held_by(behaviour))
        return self


def _held_by(behaviour: Behaviour) -> Floats:
    """Return how far torso and neck are from rest (k,) [rad] after one behaviour alone."""
    key = repr(behaviour.action)
    if key not in _ALONE:
        block = parse(TEXT.format("b", ""))
        alone = replace(block, behaviours=(replace(behaviour, syncs={}),))
        controls = plan_block(alone, setup_once()).trajectory.controls
        _ALONE[key] = np.asarray((controls[-1] - setup_once().robot.skeleton.rest)[trunk()])
    return _ALONE[key]
