"""Chains of blocks that hold a posture."""

from dataclasses import replace
from functools import cache

import numpy as np

from kinesic.bml.block import Behaviour
from kinesic.bml.composition import BlockState
from kinesic.bml.parse import parse
from kinesic.body.arrays import Floats
from kinesic.expressivity.behaviours import stays
from kinesic.motion.limit_check import check_limits
from kinesic.planning.plan import plan_block
from kinesic.planning.setup import Setup
from kinesic.realizer.ending import end_behaviours
from kinesic.realizer.realizer import (
    PreparedBlock,
    Scene,
    advance,
    begin,
    change_style,
    improve_block,
    interrupt,
    prepare_block,
    take_replans,
)
from kinesic.realizer.request import Message, read_request
from kinesic.session.setup import set_up

BLOCK_XML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
GAZE_BLOCKS = (  # blocks with a gaze that persists
    '<gazeShift id="l" target="left"/>',
    '<gazeShift id="l" target="right"/>',
    '<gazeShift id="l" target="audience"/>',
    '<gazeShift id="l" target="1 0.4 0.9" start="0" end="1.4"/>',
    '<gazeShift id="l" target="1 -0.6 0.2" influence="WAIST"/>',
    '<gazeShift id="l" target="1 0.9 0.7" start="1.5"/>',
    '<headDirectionShift id="l" target="right"/>',
    '<headDirectionShift id="l" target="down"/>',
)
_POSTURE_XML = '<postureShift id="p"><pose part="{}" lexeme="{}"/></postureShift>'
STANCE_BLOCKS = (  # blocks with a body posture that persists
    _POSTURE_XML.format("WHOLEBODY", "LEANING_FORWARD"),
    _POSTURE_XML.format("BODY", "LEANING_BACKWARD"),
    _POSTURE_XML.format("BODY", "lean left"),
    _POSTURE_XML.format("BODY", "upright"),
    _POSTURE_XML.format("HEAD", "down"),
)
HOLDING_BLOCKS = (  # blocks of several behaviours, some of which persist
    GAZE_BLOCKS[0] + STANCE_BLOCKS[0],
    GAZE_BLOCKS[1] + STANCE_BLOCKS[3],
    '<gazeShift id="k" target="right" start="0"/><gazeShift id="l" target="left" start="1.6"/>',
    GAZE_BLOCKS[0] + '<head id="n" lexeme="NOD" start="0.2"/><gesture id="g" lexeme="beat" start="2"/>',
    '<wait id="w" duration="6"/>' + GAZE_BLOCKS[1],
)
PASSING_BLOCKS = (  # blocks after which nothing persists
    '<head id="n" lexeme="NOD" repetition="2"/>',
    '<head id="n" lexeme="SHAKE"/>',
    '<gaze id="z" target="right" start="0" end="2"/>',
    '<gaze id="z" target="left" start="0.5" end="3"/><head id="n" lexeme="NOD" start="1"/>',
    '<gesture id="g" lexeme="beat" mode="RIGHT_HAND"/>',
    '<gesture id="g" lexeme="large" mode="BOTH_HANDS"/>',
    '<torso id="t" lexeme="lean" amount="1" start="0" end="2"/>',
    '<posture id="t" start="0" end="3"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture>',
)
STYLE_NAMES = ("joyful", "sad", "neutral")
CLOCK_STEP = 0.05  # [s] step of the virtual clock
_HELD_ALONE: dict[str, Floats] = {}  # [rad] results of `held_alone`, by action
END_WARNING = "where it would end alone"  # part of the warning about an unreachable end posture


@cache
def setup_once() -> Setup:
    """Load the default robot and style once."""
    return set_up()


@cache
def prepared(inside: str, id: str = "b") -> PreparedBlock:
    """Plan a block."""
    setup = setup_once()
    return prepare_block(read_request(Message(BLOCK_XML.format(id, inside)), setup), setup)


def trunk() -> list[int]:
    """List the hinges of torso and neck."""
    robot = setup_once().robot
    return [*robot.joints("torso"), *robot.joints("neck")]


@cache
def held_alone(inside: str) -> Floats:
    """Return the final offset (k,) [rad] from rest of a block performed alone."""
    controls = prepared(inside).plan.trajectory.controls
    return (controls[-1] - setup_once().robot.skeleton.rest)[trunk()]


class Chain:
    """Scene in virtual time that receives one block after another."""

    def __init__(self, *, ahead: float) -> None:
        self.scene, self.now = Scene.of(setup_once(), ahead=ahead), 0.0
        self.warnings: list[str] = []
        self.limit_ratio = 0.0  # Largest limit ratio of all motions
        self._held: dict[tuple[str, str], tuple[str, float, Floats]] = {}  # Kind, end [s] and posture
        self._over: set[str] = set()
        self._sent = 0

    def wait(self, seconds: float) -> "Chain":
        """Advance the virtual clock by a duration [s]."""
        until = self.now + seconds
        while self.now < until - 1e-9:
            self.now = min(until, self.now + CLOCK_STEP)
            self._take(advance(self.scene, self.now))
        return self

    def send(self, inside: str) -> "Chain":
        """Send a block with the next unused id."""
        self._sent += 1
        return self._take(begin(self.scene, prepared(inside, f"b{self._sent}"), self.now))

    def do(self, deed: str, choice: int) -> "Chain":
        """Send a command that interrupts or changes a block or behaviour."""
        playing = [item for item in self.scene.playing if item.merged is not None and item.times]
        if not playing:
            return self
        running = playing[choice % len(playing)]
        if deed == "interrupt":
            return self._take(interrupt(self.scene, self.now, running.id))
        if deed == "leave out":
            gone = sorted(running.times)[choice % len(running.times)]
            return self._take(end_behaviours(self.scene, running, frozenset({gone}), self.now))
        style = STYLE_NAMES[choice % len(STYLE_NAMES)]
        scene, replans = take_replans(change_style(self.scene, self.now, style=style, block=running.id))
        self._take(scene)
        for request in replans:
            better = prepare_block(request, scene.setup).plan
            self._take(
                improve_block(replace(self.scene, outgoing_feedback=()), request.block.id, better, self.now)
                or self.scene
            )
        return self

    def finish(self) -> None:
        """Advance the time until every block has ended."""
        self.wait(40.0)

    @property
    def end(self) -> Floats:
        """Return the final offset (k,) [rad] of torso and neck."""
        rest = setup_once().robot.skeleton.rest
        return np.asarray((self.scene.motion.controls[-1] - rest)[trunk()])

    @property
    def expected_end(self) -> Floats:
        """Return the offset (k,) [rad] of the last gaze and the last posture shift."""
        last: dict[str, tuple[float, Floats]] = {}
        for kind, end, held in self._held.values():
            if end >= last.get(kind, (-np.inf, held))[0] - 1e-9:
                last[kind] = (end, held)
        skeleton, hinges = setup_once().robot.skeleton, trunk()
        rest = skeleton.rest[hinges]
        total = rest + sum((held for _, held in last.values()), np.zeros(len(hinges)))
        return np.asarray(np.clip(total, skeleton.lower[hinges], skeleton.upper[hinges]) - rest)

    @property
    def is_warned_of_its_end(self) -> bool:
        """Return whether a warning reports another end posture."""
        return any(END_WARNING in text for text in self.warnings)

    def _take(self, scene: Scene) -> "Chain":
        if scene.motion is not self.scene.motion:
            peaks = check_limits(scene.motion, setup_once().limits).by_quantity.values()
            self.limit_ratio = max(self.limit_ratio, *(float(peak.ratios.max()) for peak in peaks))
        self.warnings += [message.xml for message in scene.outgoing_feedback if "<warningFeedback" in message.xml]
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
    """Return the final offset (k,) [rad] from rest of a behaviour performed alone."""
    key = repr(behaviour.action)
    if key not in _HELD_ALONE:
        block = parse(BLOCK_XML.format("b", ""))
        alone = replace(block, behaviours=(replace(behaviour, syncs={}),))
        controls = plan_block(alone, setup_once()).trajectory.controls
        _HELD_ALONE[key] = np.asarray((controls[-1] - setup_once().robot.skeleton.rest)[trunk()])
    return _HELD_ALONE[key]
