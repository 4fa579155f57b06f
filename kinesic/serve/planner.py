"""The process that plans: it reads documents, keeps the scene, and proposes motions and feedback to the loop."""

import traceback
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import isfinite
from multiprocessing.connection import Connection, wait

from kinesic.bml.block import BmlError, Bounds
from kinesic.body.config import ConfigError
from kinesic.expressivity.style.style import Style, style_preset
from kinesic.planning.setup import Setup
from kinesic.realizer.contention import with_engaged_hands
from kinesic.realizer.realizer import (
    Scene,
    advance,
    begin,
    begin_idle,
    change_manner,
    improve_block,
    interrupt,
    prepare_block,
)
from kinesic.realizer.release import release_motion
from kinesic.realizer.request import Message, block_id, read_request, refusal_feedback
from kinesic.serve.idling import IdleScheduler
from kinesic.serve.messages import (
    ClientRequest,
    DocumentRequest,
    Halted,
    Interruption,
    LoopProperties,
    LoopStart,
    PlannerReady,
    Renewal,
    RequestDone,
    Restyling,
    Resumption,
    Words,
)
from kinesic.serve.refiner import RefinedPlan, RefinementJob, pack, unpack
from kinesic.serve.renewal import renew_setup
from kinesic.serve.shared_scene import SharedScene, Verdict
from kinesic.serve.talks import Talks
from kinesic.serve.warm_up import warm_up
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.quotas import Quotas, quota_feedback

LOOK = 0.05  # [s] between two looks at what is due
DEFECTS = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    LookupError,
    MemoryError,
    RuntimeError,
    TypeError,
    ValueError,
)  # of a program
REASONS = {
    Verdict.STOPPED: ("stopped", "an emergency stop came; resume first"),
    Verdict.LATE: ("planning", "it was planned in time at none of its starts, the machine is too busy; send it again"),
    Verdict.UNSTEADY: ("planning", "it would have been a step from what plays by now; send it again"),
}  # rule, and why a block is not performed


def run_planner(
    make_setup: Callable[[], Setup],
    requests: Connection,
    loop: Connection,
    refiner: Connection,
    properties: LoopProperties,
    rules: Quotas,
) -> None:
    """Warms up, waits for its turn, and then plans until the server is gone.

    Args:
        make_setup: makes what planning needs.
        requests: the state of the loop when it is this planner's turn, then requests of clients, one after the other.
        loop: proposals go there, verdicts and stops come back.
        refiner: plans again what has begun.
        properties: of the loop.
        rules: how large a document may be, and how long a block.
    """
    try:
        setup = make_setup()
        warm_up(setup, properties.accompaniment)
        renewed = partial(renew_setup, make_setup)
        planning = PlannerState(setup, renewed, loop, refiner, properties, beginning=requests.recv(), rules=rules)
        loop.send(PlannerReady())
        while True:
            pending = wait([requests, loop, refiner], planning.pause)
            if loop in pending:
                planning.take_halt(loop.recv())
            elif requests in pending:
                planning.fulfil(requests.recv())
                planning.speak()
                loop.send(RequestDone())
            elif refiner in pending:
                planning.improve(refiner.recv_bytes())
            else:
                planning.go_on()
            planning.speak()
            planning.request_refinement()
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


class PlannerState:
    """Keeps the scene, and changes it as the loop can follow."""

    def __init__(
        self,
        setup: Setup,
        renewed: Callable[[Setup], Setup],
        loop: Connection,
        refiner: Connection,
        properties: LoopProperties,
        *,
        beginning: LoopStart,
        rules: Quotas,
    ) -> None:
        """Begins with nothing but the motion that the loop plays, and what it still has to say."""
        self._refiner, self._clock, self._rules = refiner, properties.clock, rules
        self._bounds = Bounds(rules.message, rules.depth)
        self._renewed, self._renewals = renewed, 0  # how gestures are read anew, and how often they were
        self._refining = False  # whether the refiner is at work
        self._idling, self._talks = IdleScheduler(), Talks()
        self._shared = SharedScene(
            setup, loop, properties, beginning=beginning, owed=lambda: self._talks.senders, halted=self._fall_silent
        )

    @property
    def _scene(self) -> Scene:
        return self._shared.scene

    @property
    def pause(self) -> float | None:
        """Time until something is due [s]; None where nothing is."""
        scene = self._scene
        next_time = min(scene.next_time, self._idling.next_time(scene), self._talks.next_time(scene))
        pause = next_time - self._clock.now()
        return max(pause, LOOK) if isfinite(pause) else None

    def go_on(self) -> None:
        """Lets time pass: what is over is forgotten, blocks that may start begin, and who has nothing to do idles."""
        now = self._clock.now()
        if self._idling.next_time(self._scene) > now:
            self._shared.propose(advance)
            return
        spell, before = self._idling.plan_next(self._scene.setup), self._scene.idle
        self._shared.propose(lambda scene, now: begin_idle(advance(scene, now), spell, now))
        if self._scene.idle is before:
            self._idling.postpone(now)

    def fulfil(self, request: ClientRequest) -> None:
        """Does what a client requests, once every emergency stop is known that was before it."""
        if isinstance(request, DocumentRequest | Resumption):
            self._shared.catch_up(request.stops)
        match request:
            case DocumentRequest(message):
                self._idling.allow(self._clock.now())
                self._hear(message) if isinstance(message, Words) else self._plan(request)
            case Interruption(block):
                if block is None:
                    self._fall_silent()
                self._shared.propose(lambda scene, now: interrupt(scene, now, block))
            case Restyling():
                self._restyle(request)
            case Renewal():
                self._shared.renew(self._renewed(self._scene.setup))
                self._renewals += 1
            case Resumption(stops) if stops == self._shared.stops:
                self._shared.propose(_resume)

    def speak(self) -> None:
        """Says the next phrases of texts that come word by word, as soon as they are whole and it is their turn."""
        while (phrase := self._talks.next_phrase(self._scene, self._clock.now())) is not None:
            self._tell(phrase.answer, phrase.sender)
            if phrase.replaced:
                self._shared.propose(phrase.make_way)
            self._plan(DocumentRequest(Message(phrase.bml, phrase.sender, "<words>"), self._shared.stops))
        for sender, block in self._talks.finished(self._scene.setup):
            self._tell(json_answer("all_said", block=block), sender)

    def _hear(self, words: Words) -> None:
        """Takes words, and lets the loop know that their client is owed something."""
        refusal = self._talks.take(words, self._clock.now())
        if refusal:
            self._tell(quota_feedback("waiting", refusal), words.sender)
        self._shared.propose(advance)

    def request_refinement(self) -> None:
        """Has the refiner plan the first block that could be planned better, when it has nothing else to do."""
        if self._refining or (replan := self._shared.take_replan()) is None:
            return
        self._refiner.send_bytes(pack(RefinementJob(replan, self._scene.setup.style, self._renewals)))
        self._refining = True

    def improve(self, data: bytes) -> None:
        """Goes over into a plan of the refiner, where that is still possible."""
        self._refining = False
        better = unpack(data, self._scene.setup)
        if not isinstance(better, RefinedPlan) or (found := better.plan) is None:
            return

        def change(scene: Scene, now: float) -> Scene:
            after = advance(scene, now)
            return improve_block(after, better.block, found, now) or after

        self._shared.propose(change)

    def take_halt(self, halted: Halted) -> None:
        """Takes over the motion of an emergency stop, which interrupts every block."""
        self._shared.take_halt(halted)

    def _fall_silent(self) -> None:
        """Forgets all that would begin by itself."""
        self._idling.forbid()
        self._talks.clear()

    def _plan(self, document: DocumentRequest) -> None:
        """Plans a document and proposes it. A defect that shows in planning costs this document and nothing else.

        All that can fail comes before the proposal is sent, and leaves the scene as it was.
        """
        message = document.message
        try:
            self._try_to_plan(document)
        except BmlError as error:
            self._tell(refusal_feedback(message, error), message.sender)
        except DEFECTS as error:
            traceback.print_exception(error)
            what = f"planning failed ({type(error).__name__}), and it is not performed; please report the document"
            self._tell(quota_feedback("planning", what, name=block_id(message.text)), message.sender)

    def _try_to_plan(self, document: DocumentRequest) -> None:
        message = document.message
        context = self._scene.context(self._clock.now())
        read = read_request(message, self._scene.setup, context=context, bounds=self._bounds)
        request = with_engaged_hands(self._scene, read)
        id, timeline = request.block.id, request.timeline
        if timeline.end - timeline.start > self._rules.duration:
            what = f"{id} lasts {timeline.end:.0f} s, at most {self._rules.duration:g} s are taken: split it"
            self._tell(quota_feedback("duration", what, name=id), message.sender)
            return
        self._tell(request.prediction, message.sender)
        prepared = prepare_block(request, self._scene.setup)
        verdict = Verdict.STOPPED
        if document.stops == self._shared.stops:
            verdict = self._shared.propose(lambda scene, now: begin(scene, prepared, now))
        if verdict is not Verdict.ACCEPTED:
            rule, why = REASONS[verdict]
            self._tell(quota_feedback(rule, why, name=id), message.sender)

    def _restyle(self, request: Restyling) -> None:
        try:
            style: Style | str | None = request.style
            if request.block is None and (request.style or request.changes):
                base = style_preset(request.style) if request.style else self._scene.setup.style
                style = base.changed(request.changes)
            self._shared.propose(
                lambda scene, now: change_manner(scene, now, style=style, amount=request.amount, block=request.block)
            )
        except (ConfigError, ValueError) as error:
            self._tell(json_answer("refused", do="style", why=str(error)), request.sender)

    def _tell(self, message: str, sender: int) -> None:
        self._shared.tell(message, sender)


def _resume(scene: Scene, now: float) -> Scene:
    everything = scene.setup.limits.lower < scene.setup.limits.upper
    motion = release_motion(scene.motion, scene.first_change(now), everything, scene.setup)
    return replace(scene, motion=replace(motion), lasting=())  # another motion in any case: its coming ends the stop
