"""Planner process of the server.

It reads documents, keeps the scene of running blocks, and proposes motions and feedback to the loop.
"""

import traceback
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from math import isfinite
from multiprocessing.connection import wait

from kinesic.bml.block import BmlError, DocumentBounds
from kinesic.body.config import ConfigError
from kinesic.child import PipeEnd
from kinesic.conversation.wants import Yield
from kinesic.expressivity.style.style import Style, style_preset
from kinesic.heap import freeze_heap
from kinesic.planning.setup import Setup
from kinesic.realizer.contention import with_busy_hands
from kinesic.realizer.realizer import (
    Scene,
    advance,
    begin,
    begin_idle,
    change_style,
    improve_block,
    interrupt,
    prepare_block,
)
from kinesic.realizer.release import release_motion
from kinesic.realizer.request import Message, block_id, read_request, refusal_feedback
from kinesic.realizer.spoken import divide_speeches
from kinesic.serve.conversing import Conversation, PlannerWant
from kinesic.serve.idling import IdleScheduler
from kinesic.serve.messages import (
    ClientRequest,
    ConversationRequest,
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
from kinesic.serve.rejections import DEFECT_TYPES, REJECTION_REASONS
from kinesic.serve.renewal import renew_setup
from kinesic.serve.shared_scene import SharedScene, Verdict
from kinesic.serve.talks import Talks
from kinesic.serve.warm_up import warm_up
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.quotas import Quotas, quota_feedback

TEXT_TABLES_MODULE = "kinesic.intent.read_ahead"  # module with the tables for texts, imported once for all planners
MIN_POLL_PERIOD = 0.05  # [s] smallest time between two checks for due events


def run_planner(
    make_setup: Callable[[], Setup],
    requests: PipeEnd,
    loop: PipeEnd,
    refiner: PipeEnd,
    properties: LoopProperties,
    rules: Quotas,
) -> None:
    """Warm up, wait for activation, and plan until the server ends.

    Args:
        make_setup: creates the setup for planning.
        requests: first the state of the loop, which activates this planner, then client requests in sequence.
        loop: proposals are sent to it; verdicts and emergency stops are received from it.
        refiner: process that replans blocks in the background.
        properties: constant properties of the loop.
        rules: limits for document size and block duration.
    """
    try:
        setup = make_setup()
        warm_up(setup, properties.accompaniment)
        freeze_heap()
        renewed = partial(renew_setup, make_setup)
        state = PlannerState(setup, renewed, loop, refiner, properties, beginning=requests.recv(), rules=rules)
        loop.send(PlannerReady())
        while True:
            pending = wait([requests, loop, refiner], state.pause)
            if loop in pending:
                state.handle_stop(loop.recv())
            elif requests in pending:
                state.execute(requests.recv())
                state.plan_phrases()
                loop.send(RequestDone())
            elif refiner in pending:
                state.apply_refinement(refiner.recv_bytes())
            else:
                state.advance_scene()
            state.plan_phrases()
            state.request_refinement()
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


class PlannerState:
    """Planner state: running blocks, streamed texts, idling and refinements.

    The scene of running blocks changes only by proposals that the loop accepts.
    """

    def __init__(
        self,
        setup: Setup,
        renewed: Callable[[Setup], Setup],
        loop: PipeEnd,
        refiner: PipeEnd,
        properties: LoopProperties,
        *,
        beginning: LoopStart,
        rules: Quotas,
    ) -> None:
        """Create the planner's state from the current state of the loop."""
        self._refiner, self._clock, self._rules = refiner, properties.clock, rules
        self._bounds = DocumentBounds(rules.message, rules.depth)
        self._renewed, self._renewals = renewed, 0  # lexicon reload, and number of reloads
        self._refining = False  # whether the refiner has a job
        self._idling, self._talks = IdleScheduler(), Talks(setup.character)
        self._shared = SharedScene(
            setup,
            loop,
            properties,
            beginning=beginning,
            other_clients=lambda: self._talks.senders,
            on_halt=self._halt,
        )
        self._conversation = Conversation(self._shared, shows_eyes=properties.accompaniment.face)

    @property
    def _scene(self) -> Scene:
        return self._shared.scene

    @property
    def pause(self) -> float | None:
        """Time [s] until the planner's next due event, or None without one."""
        scene = self._scene
        now, conversation = self._clock.now(), self._conversation
        times = (self._idling.next_time(scene), self._talks.next_time(scene), conversation.next_time(now))
        pause = min(scene.next_time, *times) - now
        return max(pause, MIN_POLL_PERIOD) if isfinite(pause) else None

    def advance_scene(self) -> None:
        """Advance the scene: remove ended blocks, start waiting blocks, or idle."""
        now = self._clock.now()
        self._perform_wants(self._conversation.advance(now))
        if self._idling.next_time(self._scene) > now:
            self._shared.propose(advance)
            return
        spell, before = self._idling.plan_next(self._scene.setup), self._scene.idle
        self._shared.propose(lambda scene, now: begin_idle(advance(scene, now), spell, now))
        if self._scene.idle is before:
            self._idling.postpone(now)

    def execute(self, request: ClientRequest) -> None:
        """Execute a client request, after the stops that preceded it."""
        if isinstance(request, DocumentRequest | ConversationRequest | Resumption):
            self._shared.wait_for_stops(request.stops)
        match request:
            case DocumentRequest(message):
                self._idling.allow(self._clock.now())
                self._queue_words(message) if isinstance(message, Words) else self._plan(request)
            case Interruption():
                self._interrupt(request)
            case Restyling():
                self._restyle(request)
            case ConversationRequest(stops=stops) if stops == self._shared.stops:
                self._perform_wants(self._conversation.take(request, self._clock.now()))
                if self._conversation.is_on:
                    self._idling.allow(self._clock.now())
            case Renewal():
                self._shared.renew(self._renewed(self._scene.setup))
                self._renewals += 1
            case Resumption(stops) if stops == self._shared.stops:
                self._shared.propose(_resume)

    def _interrupt(self, request: Interruption) -> None:
        """End blocks, and report the spoken text of yielding ones."""
        if request.block is None:
            self._cancel_pending()
        texts = divide_speeches(self._scene, request.silenced, request.block)
        senders = {running.id: running.sender for running in self._scene.playing}
        sound = self._scene.foreign_sound
        self._shared.propose(lambda scene, now: interrupt(scene, now, request.block, yields=request.yields))
        if sound is not None and request.yields and request.block is None:
            self._conversation.report_yielded(sound, request.silenced)
        for block, text in texts.items() if request.yields else ():
            if self._scene.find(block) is None:
                answer = json_answer("yielded", block=block, said=text.said, unsaid=text.unsaid)
                for client in dict.fromkeys((senders[block], request.sender)):
                    if client is not None:
                        self._tell(answer, client)

    def _perform_wants(self, wants: Iterable[PlannerWant]) -> None:
        """Stop own speech for a person's turn, or plan a filler."""
        for want in wants:
            if isinstance(want, Yield):
                self._interrupt(Interruption(None, True, self._clock.now(), self._conversation.owner))
            else:
                message = Message(want.bml, self._conversation.owner, want.source)
                self._plan(DocumentRequest(message, self._shared.stops))

    def plan_phrases(self) -> None:
        """Plan the next complete phrases of streamed texts in turn."""
        while (phrase := self._talks.next_phrase(self._scene, self._clock.now())) is not None:
            self._tell(phrase.answer, phrase.sender)
            if phrase.replaced:
                self._shared.propose(phrase.scene_change)
            self._plan(DocumentRequest(Message(phrase.bml, phrase.sender, "<words>"), self._shared.stops))
        for sender, block in self._talks.finished(self._scene.setup):
            self._tell(json_answer("all_said", block=block), sender)

    def _queue_words(self, words: Words) -> None:
        """Queue streamed text, or tell its client why it is refused."""
        refusal = self._talks.take(words, self._clock.now())
        if refusal:
            self._tell(quota_feedback("waiting", refusal), words.sender)
        self._shared.propose(advance)

    def request_refinement(self) -> None:
        """Send the next block to replan to the refiner, unless busy."""
        if self._refining or (replan := self._shared.pop_replan()) is None:
            return
        self._refiner.send_bytes(pack(RefinementJob(replan, self._scene.setup.style, self._renewals)))
        self._refining = True

    def apply_refinement(self, data: bytes) -> None:
        """Switch a block to its refined plan if that is still possible."""
        self._refining = False
        refined = unpack(data, self._scene.setup)
        if not isinstance(refined, RefinedPlan) or (new_plan := refined.plan) is None:
            return

        def change(scene: Scene, now: float) -> Scene:
            after = advance(scene, now)
            return improve_block(after, refined.block, new_plan, now) or after

        self._shared.propose(change)

    def handle_stop(self, halted: Halted) -> None:
        """Adopt the motion of an emergency stop, which interrupts all blocks."""
        self._shared.handle_stop(halted)

    def _halt(self) -> None:
        """Drop everything that would move the robot after an emergency stop."""
        self._cancel_pending()
        self._conversation.end(self._clock.now(), moves=False)

    def _cancel_pending(self) -> None:
        """Drop all unspoken text, and begin no further idle motion."""
        self._idling.forbid()
        self._talks.clear()

    def _plan(self, document: DocumentRequest) -> None:
        """Plan a document and propose it to the loop.

        An internal error in planning affects only this document: everything that can fail precedes the proposal and
        leaves the scene unchanged.
        """
        message = document.message
        try:
            self._try_to_plan(document)
        except BmlError as error:
            self._tell(refusal_feedback(message, error), message.sender)
        except DEFECT_TYPES as error:
            traceback.print_exception(error)
            what = f"planning failed ({type(error).__name__}), the document is not performed; please report it"
            self._tell(quota_feedback("planning", what, name=block_id(message.text)), message.sender)

    def _try_to_plan(self, document: DocumentRequest) -> None:
        message = document.message
        context = self._scene.context(self._clock.now())
        read = read_request(message, self._scene.setup, context=context, bounds=self._bounds)
        request = with_busy_hands(self._scene, read)
        id, timeline = request.block.id, request.timeline
        if timeline.end - timeline.start > self._rules.duration:
            what = f"{id} lasts {timeline.end:.0f} s, at most {self._rules.duration:g} s are taken: split it"
            self._tell(quota_feedback("duration", what, name=id), message.sender)
            return
        self._tell(request.prediction, message.sender)
        prepared = prepare_block(request, self._scene.setup, is_scheduled=True)
        verdict = Verdict.STOPPED
        if document.stops == self._shared.stops:
            verdict = self._shared.propose(lambda scene, now: begin(scene, prepared, now))
        if verdict is not Verdict.ACCEPTED:
            rule, why = REJECTION_REASONS[verdict]
            self._tell(quota_feedback(rule, why, name=id), message.sender)

    def _restyle(self, request: Restyling) -> None:
        try:
            style: Style | str | None = request.style
            if request.block is None and (request.style or request.changes):
                base = style_preset(request.style) if request.style else self._scene.setup.style
                style = base.changed(request.changes)
            self._shared.propose(
                lambda scene, now: change_style(scene, now, style=style, amount=request.amount, block=request.block)
            )
        except (ConfigError, ValueError) as error:
            self._tell(json_answer("refused", do="style", why=str(error)), request.sender)

    def _tell(self, message: str, sender: int) -> None:
        self._shared.tell(message, sender)


def _resume(scene: Scene, now: float) -> Scene:
    movable = scene.setup.limits.lower < scene.setup.limits.upper
    motion = release_motion(scene.motion, scene.first_change(now), movable, scene.setup)
    return replace(scene, motion=replace(motion), lasting=())  # a new object in any case: a new motion ends the stop
