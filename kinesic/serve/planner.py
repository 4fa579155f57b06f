"""The process that plans: it reads documents, keeps the scene, and proposes motions and agendas to the loop."""

import signal
from collections.abc import Callable
from dataclasses import replace
from math import isfinite
from multiprocessing.connection import Connection, wait

from kinesic.bml.block import BmlError, Bounds
from kinesic.body.config import ConfigError
from kinesic.expressivity.style.style import Style
from kinesic.planning.setup import Setup
from kinesic.realizer.contention import with_engaged_hands
from kinesic.realizer.realizer import (
    Scene,
    advance,
    begin,
    change_manner,
    improve_block,
    interrupt,
    prepare,
)
from kinesic.realizer.release import release_motion
from kinesic.realizer.request import Message, read_request, refusal_feedback
from kinesic.serve.clock import Clock
from kinesic.serve.messages import (
    DocumentRequest,
    FeedbackNotice,
    Halted,
    Interruption,
    LoopStart,
    PlannerReady,
    Proposal,
    ProposalVerdict,
    RequestDone,
    Restyling,
    Resumption,
    Wanted,
)
from kinesic.serve.protocol import json_answer
from kinesic.serve.quotas import Quotas, quota_feedback
from kinesic.serve.refiner import RefinedPlan, RefinementJob, pack, unpack
from kinesic.serve.tracks import Track, Version, track, version

MARGIN = 0.015  # [s] from a proposal to its cut, beside what it takes to make it
LONGEST = 1.0  # [s] that making one may take
SLOWER = 0.7  # share of that which is kept when the next one takes less
ATTEMPTS = 5  # at being in time
LOOK = 0.05  # [s] between two looks at what is due
WARMING = (
    '<bml id="warming"><head id="nod" lexeme="NOD" start="0"/><gesture id="beat" lexeme="BEAT" start="0"/>'
    '<faceLexeme id="brows" lexeme="RAISE_BROWS" start="0"/><speech id="yes"><text>Yes.</text></speech></bml>'
)

Change = Callable[[Scene, float], Scene]


def run_planner(
    make_setup: Callable[[], Setup],
    wishes: Connection,
    loop: Connection,
    improver: Connection,
    clock: Clock,
    beginning: LoopStart,
    rules: Quotas,
) -> None:
    """Plans until the server is gone.

    Args:
        make_setup: makes what planning needs.
        wishes: what clients want comes here, one after the other.
        loop: proposals go there, verdicts and stops come back.
        improver: plans again what has begun.
        clock: the server's.
        beginning: what plays.
        rules: how large a document may be, and how long a block.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server, which then folds the robot
    try:
        planning = PlannerState(make_setup(), loop, improver, clock, beginning, rules)
        loop.send(PlannerReady())
        while True:
            heard = wait([wishes, loop, improver], planning.pause)
            if loop in heard:
                planning.heard(loop.recv())
            elif wishes in heard:
                planning.fulfil(wishes.recv())
                loop.send(RequestDone())
            elif improver in heard:
                planning.improve(improver.recv_bytes())
            else:
                planning.go_on()
            planning.ask_for_better()
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


class PlannerState:
    """The scene, and how it changes."""

    def __init__(
        self,
        setup: Setup,
        loop: Connection,
        improver: Connection,
        clock: Clock,
        beginning: LoopStart,
        rules: Quotas,
    ) -> None:
        """Warms up by planning a block that nobody sees."""
        self._loop, self._improver, self._clock, self._rules = loop, improver, clock, rules
        self._bounds = Bounds(rules.message, rules.depth)
        self._stops, self._took = beginning.stops, 0.0
        self._senses, self._versions = beginning.senses, dict[str, Version]()  # of the tracks that the loop has
        self._improving = False  # whether the improver is at work
        warming = begin(Scene.of(setup), prepare(read_request(Message(WARMING), setup), setup), 0.0)
        for running in warming.playing:
            track(running, beginning.senses)
        advance(warming, 0.1)
        self._scene = replace(Scene.of(setup), motion=beginning.motion, agenda=beginning.agenda)

    @property
    def pause(self) -> float | None:
        """[s] until something is due; None: nothing is."""
        due = self._scene.next_time - self._clock.now()
        return max(due, LOOK) if isfinite(due) else None

    def go_on(self) -> None:
        """Lets time pass: what is over is forgotten, and whose turn it is begins."""
        self._propose(advance)

    def fulfil(self, wanted: Wanted) -> None:
        """Does what a client wants, once every emergency stop is known that was before it."""
        if isinstance(wanted, DocumentRequest | Resumption):
            self._catch_up(wanted.stops)
        match wanted:
            case DocumentRequest():
                self._plan(wanted)
            case Interruption(block):
                self._propose(lambda scene, now: interrupt(scene, now, block))
            case Restyling():
                self._restyle(wanted)
            case Resumption(stops) if stops == self._stops:
                self._propose(_resumed)

    def ask_for_better(self) -> None:
        """Has the improver plan the first block that could be planned better, when it has nothing else to do."""
        if self._improving or not self._scene.replans:
            return
        first, *others = self._scene.replans
        self._scene = replace(self._scene, replans=tuple(others))
        self._improver.send_bytes(pack(RefinementJob(first, self._scene.setup.style)))
        self._improving = True

    def improve(self, data: bytes) -> None:
        """Goes over into what the improver has found, where that is still possible."""
        self._improving = False
        better = unpack(data, self._scene.setup)
        if not isinstance(better, RefinedPlan) or (found := better.plan) is None:
            return

        def change(scene: Scene, now: float) -> Scene:
            after = advance(scene, now)
            return improve_block(after, better.block, found, now) or after

        self._propose(change)

    def heard(self, halted: Halted) -> None:
        """Takes over what the loop has made of an emergency stop: every block is interrupted, and stays where it is."""
        self._stops = halted.stops

        self._propose(lambda scene, _now: replace(interrupt(scene, halted.time), motion=halted.motion), moves=False)

    def _catch_up(self, stops: int) -> None:
        """Waits for the loop to say what became of the motion at so many stops, which it does in its next tick."""
        while self._stops < stops:
            self.heard(self._loop.recv())

    def _plan(self, document: DocumentRequest) -> None:
        message = Message(document.text, document.sender, document.source)
        try:
            around = self._scene.context(self._clock.now())
            known = with_engaged_hands(
                self._scene, read_request(message, self._scene.setup, context=around, bounds=self._bounds)
            )
            if known.timeline.end - known.timeline.start > self._rules.duration:
                what = (
                    f"{known.block.id} lasts {known.timeline.end:.0f} s, at most {self._rules.duration:g} s are taken"
                )
                self._loop.send(
                    FeedbackNotice(
                        quota_feedback("duration", f"{what}: split it", name=known.block.id), document.sender
                    )
                )
                return
            self._loop.send(FeedbackNotice(known.prediction, document.sender))
            coming = prepare(known, self._scene.setup)
        except BmlError as error:
            self._loop.send(FeedbackNotice(refusal_feedback(message, error), document.sender))
            return
        if document.stops != self._stops or not self._propose(lambda scene, now: begin(scene, coming, now)):
            text = quota_feedback("stopped", "an emergency stop came; resume first", name=known.block.id)
            self._loop.send(FeedbackNotice(text, document.sender))

    def _restyle(self, wanted: Restyling) -> None:
        try:
            style: Style | str | None = wanted.style
            if wanted.block is None and (wanted.style or wanted.changes):
                manner = Style.load(wanted.style) if wanted.style else self._scene.setup.style
                style = manner.changed(wanted.changes)
            self._propose(
                lambda scene, now: change_manner(scene, now, style=style, amount=wanted.amount, block=wanted.block)
            )
        except (ConfigError, ValueError) as error:
            self._loop.send(FeedbackNotice(json_answer("refused", do="style", why=str(error)), wanted.sender))

    def _propose(self, change: Change, *, moves: bool = True) -> bool:
        """Changes the scene as soon as the loop can follow; False when it cannot, or an emergency stop came before.

        Args:
            change: from a scene and a time [s].
            moves: whether the loop is to play the motion; else it plays it already.
        """
        for _ in range(ATTEMPTS):
            now = self._clock.now()
            ahead = self._took + MARGIN
            scene = change(replace(self._scene, ahead=ahead, said=()), now)
            self._took = min(LONGEST, max(self._clock.now() - now, SLOWER * self._took))
            motion = scene.motion if moves and scene.motion is not self._scene.motion else None
            versions, tracks = self._tracks(scene)
            owed = frozenset(running.sender for running in scene.blocks)
            moving = {
                (running.id, busy.behaviour): busy.hinges for running in scene.blocks for busy in running.occupancy
            }
            self._loop.send(
                Proposal(self._stops, now, now + ahead, motion, (*scene.said, *scene.agenda), owed, moving, tracks)
            )
            halted, verdict = self._answer()
            if verdict.taken:
                self._scene, self._versions = scene, versions
            if halted is not None:
                self.heard(halted)
            if verdict.taken or halted is not None:
                return verdict.taken
            if verdict.stops > self._stops:
                self._catch_up(verdict.stops)
                return False
        return False

    def _tracks(self, scene: Scene) -> tuple[dict[str, Version], dict[str, Track | None]]:
        """What is seen and heard of the blocks that play, where the loop does not know it yet."""
        if not (self._senses.face or self._senses.sound):
            return {}, {}
        playing = {running.id: running for running in scene.playing}
        versions = {id: version(running) for id, running in playing.items()}
        over: dict[str, Track | None] = dict.fromkeys(self._versions.keys() - versions.keys())
        fresh = [id for id, own in versions.items() if self._versions.get(id) != own]
        return versions, over | {id: track(playing[id], self._senses) for id in fresh}

    def _answer(self) -> tuple[Halted | None, ProposalVerdict]:
        """The loop's verdict, and what it had to say before it."""
        halted = None
        while not isinstance(heard := self._loop.recv(), ProposalVerdict):
            halted = heard
        return halted, heard


def _resumed(scene: Scene, now: float) -> Scene:
    """Back to rest, all hinges together."""
    everything = scene.setup.limits.lower < scene.setup.limits.upper
    motion = release_motion(scene.motion, scene.first_change(now), everything, scene.setup)
    return replace(scene, motion=replace(motion))  # another one in any case: its coming ends the stop
