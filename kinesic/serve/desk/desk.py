"""Answers clients' questions: what is quick at once, what is to be planned in a process of its own."""

from asyncio import Task, create_task, current_task, sleep
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from msgspec.structs import asdict

from kinesic.body.config import ConfigError
from kinesic.body.robot import SIDES
from kinesic.planning.setup import Setup
from kinesic.serve.desk.documents import DocumentFolder
from kinesic.serve.desk.drafter import Drafter, Send
from kinesic.serve.desk.reach import reach_posture
from kinesic.serve.loop import Loop
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.questions import (
    GestureQuestion,
    OpenRequest,
    PlanQuestion,
    Question,
    ReachQuestion,
    SaveRequest,
    WatchRequest,
)
from kinesic.serve.wire.quotas import Quotas

GESTURE_SUFFIX = ".toml"  # of a file of gestures
MAX_WATCH_RATE = 50.0  # [Hz] at which a client may watch
DIGITS = 4  # of angles [rad] and lengths [m]


@dataclass(frozen=True, eq=False)
class Asker:
    """A client with a question."""

    number: int
    send: Send
    is_there: Callable[[], bool]


class Desk:
    """Answers questions; everything here happens in the asyncio loop of the server."""

    def __init__(
        self,
        make_setup: Callable[[], Setup],
        setup: Setup,
        loop: Loop,
        rules: Quotas,
        *,
        folder: Path | None = None,
        on_gestures_saved: Callable[[], None] = lambda: None,
    ) -> None:
        """Opens; nothing is begun before the first question.

        Args:
            make_setup: makes what planning needs, in another process.
            setup: the same, made here.
            loop: of the robot that is watched.
            rules: for documents that are planned.
            folder: where documents are kept; None: nowhere.
            on_gestures_saved: called when gestures were saved there.
        """
        self._on_gestures_saved = on_gestures_saved
        self._setup, self._loop = setup, loop
        self._documents = DocumentFolder(folder)
        self._watches: dict[int, Task[None]] = {}  # by client
        self.drafter = Drafter(make_setup, rules)

    def answer(self, asker: Asker, question: Question) -> None:
        """Answers a question, now or when its answer is known."""
        match question:
            case ReachQuestion():
                asker.send(self._reach(question))
            case PlanQuestion() | GestureQuestion():
                self.drafter.ask(asker.number, question, asker.send)
            case WatchRequest(rate):
                self._watch(asker, rate)
            case SaveRequest() | OpenRequest():
                asker.send(self._save_or_open(question))

    def close(self) -> None:
        """Ends all that it has begun."""
        for task in self._watches.values():
            task.cancel()
        self.drafter.close()

    def _reach(self, question: ReachQuestion) -> str:
        robot, rest = self._setup.robot, self._setup.robot.skeleton.rest
        start = rest if question.posture is None else np.array(question.posture, dtype=np.float64)
        target = np.array(question.target, dtype=np.float64)
        if start.shape != rest.shape:
            why = f"posture has {len(start)} angles, {robot.name} has {len(rest)} hinges"
            return json_answer("refused", do="reach", id=question.id, why=why)
        side = next(side for side in SIDES if question.side.startswith(side))
        found = reach_posture(robot, self._setup.distances, side, target, start)
        return json_answer(
            "reach",
            id=question.id,
            angles=[round(float(angle), DIGITS) for angle in found.angles],
            residual=round(found.residual, DIGITS),
            reached=found.reached,
            limits=found.limits,
            contact=found.contact,
        )

    def _save_or_open(self, request: SaveRequest | OpenRequest) -> str:
        try:
            match request:
                case SaveRequest(name, text):
                    self._documents.save(name, text)
                    if name.endswith(GESTURE_SUFFIX):
                        self.drafter.renew()
                        self._on_gestures_saved()
                    return json_answer("saved", id=request.id, name=name)
                case OpenRequest(str(name)):
                    return json_answer("document", id=request.id, name=name, text=self._documents.read(name))
                case OpenRequest():
                    return json_answer("documents", id=request.id, names=self._documents.names())
        except (ConfigError, OSError) as error:
            return json_answer("refused", do=_verb(request), id=request.id, why=str(error))

    def _watch(self, asker: Asker, rate: float) -> None:
        before = self._watches.pop(asker.number, None)
        if before is not None:
            before.cancel()
        if rate > 0.0:
            self._watches[asker.number] = create_task(self._report(asker, 1.0 / min(rate, MAX_WATCH_RATE)))

    async def _report(self, asker: Asker, period: float) -> None:
        """Tells a client how the robot is until it is gone."""
        try:
            while asker.is_there():
                asker.send(json_answer("body", **asdict(self._loop.body())))
                await sleep(period)
        finally:
            if self._watches.get(asker.number) is current_task():  # not one at another rate that has replaced it
                del self._watches[asker.number]


def _verb(request: SaveRequest | OpenRequest) -> str:
    return "save" if isinstance(request, SaveRequest) else "open"
