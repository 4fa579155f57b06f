"""Conversation of a client, performed beneath the blocks of a scene."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import copysign, inf, radians

import numpy as np

from kinesic.body.robot import Robot
from kinesic.conversation.advance import advance_conversation, next_time
from kinesic.conversation.events import ConversationEvent, Conversing, Place, RobotSpeech, SoundPiece, SoundPosition
from kinesic.conversation.state import ConversationState
from kinesic.conversation.turn_words import turn_words
from kinesic.conversation.wants import (
    BodyLean,
    BriefExpression,
    Filler,
    HeldExpression,
    Look,
    ModeNotice,
    Nod,
    Want,
    Yield,
)
from kinesic.expressivity.gaze import eye_place, towards
from kinesic.expressivity.keyframes import HeldTurns, Turn
from kinesic.expressivity.turns import UPRIGHT_TURN, add_turns, clip_turn, rotation_range, scale_turn
from kinesic.planning.setup import Setup
from kinesic.planning.torso import compute_torso_turn
from kinesic.realizer.follow_steps import FOLLOWING_PREFIX, FollowedFace, Glimpse
from kinesic.realizer.following import follow, is_looking_elsewhere, nod
from kinesic.realizer.foreign_sound import ForeignSound
from kinesic.realizer.realizer import Scene, advance
from kinesic.serve.changeable_scene import ChangeableScene
from kinesic.serve.conversation_blocks import FILLER_BLOCK, ConversationBlock, filler_block
from kinesic.serve.messages import ConversationRequest
from kinesic.serve.sound_performance import SoundPerformance
from kinesic.serve.wire.protocol import json_answer

MAX_HEAD_ANGLE = radians(30.0)  # [rad] horizontal gaze angle above which the trunk turns, too
MIN_HEAD_FRACTION = 0.5  # smallest fraction of a look away that the head of a robot without visible eyes performs
RETRY_PERIOD = 0.25  # [s] time between attempts to follow while a block determines the gaze
SPATIAL_GAIN = 0.5  # factor from the `spatial` parameter of a style to the relative change of amplitudes
MAX_SPEECH_GAP = 1.0  # [s] longest pause between two phrases that does not end the robot's speech
SPEECH_END_TOLERANCE = 0.05  # [s] smallest change of the expected end of speech that is reported
MovingWant = Look | BodyLean | Nod | BriefExpression | HeldExpression  # requests that move the body
PlannerWant = Yield | ConversationBlock  # requests that the planner performs


class Conversation:
    """Conversation of one client and its effects on the scene."""

    def __init__(self, shared: ChangeableScene, *, shows_eyes: bool) -> None:
        """Create a conversation that has not begun.

        Args:
            shared: scene that the conversation changes by proposals.
            shows_eyes: whether an output shows the eyes of the robot.
        """
        self._shared, self._shows_eyes = shared, shows_eyes
        self._state = ConversationState(eyes=_eyes(shared.scene.setup.robot))
        self._sound = SoundPerformance(shared)
        self._filler_count = 0  # number of spoken fillers, for the ids of their blocks
        self.owner = 0  # client that began the conversation
        self._fills = False  # whether the robot says fillers
        self.look = Look(None)  # current gaze
        self._retry = inf  # [s] time of the next attempt to follow
        self._speech: tuple[bool, float] = (False, inf)  # last reported activity and end [s] of own speech

    @property
    def is_on(self) -> bool:
        """Whether the robot converses."""
        return self._state.on

    def next_time(self, now: float) -> float:
        """Return the next time [s] at which `advance` must be called.

        An event may require an earlier call.
        """
        if not self.is_on:
            return inf
        speeches = self._shared.scene.speeches
        edges = [time for item in speeches for time in (item.begin, item.end) if time > now]
        words = turn_words(self._shared.scene.setup.language)
        return min([next_time(self._state, now, words=words), self._retry, self._sound.next_time(), *edges])

    def take(self, request: ConversationRequest, now: float) -> tuple[PlannerWant, ...]:
        """Apply a client's event, and return the requests for the planner."""
        event = request.event
        if isinstance(event, SoundPiece | SoundPosition):
            if not self.is_on:
                answer = json_answer("refused", do="sound", why='no conversation runs; send {"do": "converse"} first')
                self._shared.tell(answer, request.sender)
                return ()
            self._sound.take(event, request.sender, now)
            return self._advance([], now)
        if isinstance(event, Conversing):
            self._fills, was_on = request.fills, self.is_on
            self.owner = request.sender if event.on else self.owner
            if was_on and not event.on:
                return self.end(now)
        return self._advance([event], now)

    def advance(self, now: float) -> tuple[PlannerWant, ...]:
        """Advance to a time [s], and return the requests for the planner."""
        return self._advance([], now) if self.is_on else ()

    def end(self, now: float, *, moves: bool = True) -> tuple[PlannerWant, ...]:
        """End the conversation, and return the head to rest.

        Args:
            now: current time [s].
            moves: whether the head returns; False at an emergency stop.
        """
        self._state, wants = advance_conversation(self._state, Conversing(on=False), now)
        self._retry, self._speech = inf, (False, inf)
        self._sound.end()
        self._tell(wants)
        if moves:
            self._shared.propose(lambda scene, time: _rest(advance(scene, time), time))
        return ()

    def report_yielded(self, sound: ForeignSound, time: float) -> None:
        """Send the client the played duration of its sound [s]."""
        self._shared.tell(json_answer("yielded", sound=sound.id, at=sound.position(time)), self.owner)

    def _advance(self, events: list[ConversationEvent], now: float) -> tuple[PlannerWant, ...]:
        """Apply events and own speech, move, and return requests for the planner."""
        words, wants = turn_words(self._shared.scene.setup.language), list[Want]()
        speech = self._own_speech(now)
        for event in (*([] if speech is None else [speech]), *events) or (None,):
            self._state, requested = advance_conversation(self._state, event, now, words=words)
            wants += requested
        self._tell(tuple(wants))
        self._move([want for want in wants if isinstance(want, MovingWant)], now)
        beats = self._sound.advance(now, _amplitude(self._shared.scene.setup))
        yields = [want for want in wants if isinstance(want, Yield)]
        blocks = [ConversationBlock(bml, "<beat>") for bml in beats]
        return (*yields, *blocks, *self._fill([want for want in wants if isinstance(want, Filler)]))

    def _fill(self, wants: Sequence[Filler]) -> Iterator[ConversationBlock]:
        """Yield the blocks of requested fillers, if the client wants fillers."""
        for want in wants if self._fills else ():
            self._filler_count += 1
            bml = filler_block(want, self._shared.scene.setup.language, self._filler_count)
            if bml:
                yield ConversationBlock(bml, "<filler>")

    def _own_speech(self, now: float) -> RobotSpeech | None:
        """Return the start, end or new expected end of own speech.

        Without a change, it is None.
        """
        before = self._speech
        latest_begin = now + (MAX_SPEECH_GAP if before[0] else 0.0)
        spans = [
            (item.begin, item.end) for item in self._shared.scene.speeches if not item.block.startswith(FILLER_BLOCK)
        ]
        sound = self._shared.scene.foreign_sound
        if sound is not None:
            spans.append((sound.begin, sound.end if sound.is_complete else inf))
        ends = [end for begin, end in spans if begin <= latest_begin and now < end]
        active, end = bool(ends), max(ends, default=inf)
        self._speech = active, end
        if active and (not before[0] or (end != before[1] and abs(end - before[1]) > SPEECH_END_TOLERANCE)):
            return RobotSpeech(active=True, ends_in=end - now if end < inf else None)
        return RobotSpeech(active=False) if before[0] and not active else None

    def _tell(self, wants: tuple[Want, ...]) -> None:
        """Report new states and backchannels to the client."""
        for want in wants:
            if isinstance(want, ModeNotice):
                who = {} if want.who is None else {"who": want.who}
                self._shared.tell(json_answer("conversing", state=want.mode, **who), self.owner)
            elif isinstance(want, Nod):
                self._shared.tell(json_answer("backchannel", sign="nod", reason=want.reason), self.owner)

    def _move(self, wants: list[MovingWant], now: float) -> None:
        """Propose the motion of head, trunk and face."""
        looks = [want for want in wants if isinstance(want, Look)]
        self.look = looks[-1] if looks else self.look
        is_due = bool(looks) or self._retry <= now
        if not is_due and not wants:
            return
        self._retry = now + RETRY_PERIOD if is_looking_elsewhere(self._shared.scene, now) else inf

        def change(scene: Scene, time: float) -> Scene:
            scene = advance(scene, time)
            scene = follow(scene, self._gaze_turns(scene), time)
            if self._shows_eyes:
                scene = replace(scene, followed_face=self._face(scene, wants, time))
            for want in wants:
                if isinstance(want, BodyLean) and not _holds_posture(scene):
                    scene = follow(scene, _lean_turns(want, _amplitude(scene.setup)), time)
                elif isinstance(want, Nod):
                    scene = nod(scene, _amplitude(scene.setup) * radians(want.angle), time)
            return scene

        self._shared.propose(change)

    def _face(self, scene: Scene, wants: Sequence[Want], time: float) -> FollowedFace:
        """Return the gaze of the eyes and the current expressions."""
        shown, base = scene.followed_face or FollowedFace(), self._direction(scene)
        away = Turn(torsion=radians(self.look.away[0]), tilt=-radians(self.look.away[1]))
        gaze = add_turns(base, away)
        for want in wants:
            if isinstance(want, BriefExpression):
                shown = replace(shown, expression=Glimpse.brief(want.units, time, want.duration))
            elif isinstance(want, HeldExpression):
                shown = replace(shown, held=Glimpse(want.units, time, inf), faded=shown.held.ended(time))
        if gaze == shown.gaze:
            return shown
        return replace(shown, gaze=gaze, before=shown.gaze, begin=time)

    def _direction(self, scene: Scene) -> Turn:
        """Return the direction of the person, or straight ahead."""
        place = self.look.place
        return UPRIGHT_TURN if place is None else towards(np.array(place), scene.setup.robot)

    def _gaze_turns(self, scene: Scene) -> HeldTurns:
        """Return head and trunk rotations of the current look, within their ranges."""
        robot, look = scene.setup.robot, self.look
        fraction = look.head_fraction if self._shows_eyes else max(MIN_HEAD_FRACTION, look.head_fraction)
        away = Turn(torsion=radians(look.away[0]), tilt=-radians(look.away[1]))
        base = self._direction(scene)
        head = add_turns(base, scale_turn(away, fraction))
        torso = _followed_torso(scene)
        if not scene.blocks:  # pointing hands and gestures need a steady trunk
            excess = copysign(max(0.0, abs(base.torsion) - MAX_HEAD_ANGLE), base.torsion)
            torso = clip_turn(Turn(torsion=excess), rotation_range(robot, "torso"))
        neck = clip_turn(add_turns(head, scale_turn(torso, -1.0)), rotation_range(robot, "neck"))
        return HeldTurns("look", add_turns(torso, neck), torso)


def _rest(scene: Scene, now: float) -> Scene:
    """Return head, trunk and eyes smoothly to rest."""
    return replace(follow(scene, None, now), followed_face=None, foreign_sound=None)


def _eyes(robot: Robot) -> Place:
    x, y, z = (float(value) for value in eye_place(robot))
    return x, y, z


def _followed_torso(scene: Scene) -> Turn:
    """Return the trunk rotation of the gaze at the followed person."""
    entry = next((item for item in scene.lasting if item.behaviour == f"{FOLLOWING_PREFIX}look"), None)
    if entry is None or entry.offset is None:
        return UPRIGHT_TURN
    return Turn(*(float(angle) for angle in compute_torso_turn(scene.setup.robot, "torso", entry.offset)))


def _holds_posture(scene: Scene) -> bool:
    """Return whether a block holds a posture of the trunk."""
    return any(entry.holds("trunk") and not entry.behaviour.startswith(FOLLOWING_PREFIX) for entry in scene.lasting)


def _amplitude(setup: Setup) -> float:
    """Return the style's factor on amplitudes."""
    return 1.0 + SPATIAL_GAIN * setup.style.head.spatial


def _lean_turns(want: BodyLean, amplitude: float) -> HeldTurns:
    head = Turn(roll=amplitude * radians(want.tilt))
    return HeldTurns("posture", head, Turn(tilt=amplitude * radians(want.lean)))
