"""Keeps planner and refiner as child processes: one request at a time, killed when they hang, and begun anew."""

from asyncio import TimerHandle, get_running_loop
from collections.abc import Callable
from multiprocessing.connection import Connection

from kinesic.child import Child, child_context
from kinesic.controller import perform
from kinesic.planning.setup import Setup
from kinesic.serve import planner, refiner
from kinesic.serve.loop import Loop
from kinesic.serve.messages import ClientRequest, DocumentRequest, PlannerReady, RequestDone
from kinesic.serve.quotas import Quotas


class Planner:
    """The planner as the server sees it; everything here happens in the asyncio loop of the server."""

    def __init__(
        self,
        make_setup: Callable[[], Setup],
        loop: Loop,
        *,
        rules: Quotas,
        idle: Callable[[], None],
        lost: Callable[[ClientRequest | None], None],
    ) -> None:
        """Not started yet.

        Args:
            make_setup: makes what planning needs, in the other process.
            loop: gets what is planned.
            rules: how large a document may be, and how long one request may take.
            idle: called whenever it can take a request.
            lost: called with what it was doing, when it has died; it is then started again, unless it failed.
        """
        self._make_setup, self._loop, self._rules = make_setup, loop, rules
        self._idle, self._lost = idle, lost
        self._children: list[Child] = []
        self._requests: Connection | None = None
        self._watch: TimerHandle | None = None
        self._present: ClientRequest | None = None  # what it is doing
        self.warm = False
        self.deaths = 0  # so far
        self.failed = False  # it cannot even be started

    @property
    def free(self) -> bool:
        """Whether it waits for something to do."""
        return self.warm and self._present is None

    def serves(self, sender: int) -> bool:
        """Whether it plans a document of this sender."""
        return isinstance(self._present, DocumentRequest) and self._present.message.sender == sender

    def start(self) -> None:
        """Begins both processes; the planner says when it is warm."""
        slow = (planner.__name__, perform.__name__, self._make_setup.__module__)
        context = child_context(*slow)  # nothing of the server's threads
        requests, self._requests = context.Pipe(duplex=False)
        to_planner, to_loop = context.Pipe()
        from_planner, to_refiner = context.Pipe()
        beginning = self._loop.beginning()
        given = (self._make_setup, requests, to_loop, to_refiner, beginning, self._rules)
        self._children = [
            Child(context, planner.run_planner, *given, name="planner"),
            Child(context, refiner.run_refiner, self._make_setup, from_planner, name="refiner"),
        ]
        self._loop.link(to_planner, beginning)

    def send(self, request: ClientRequest) -> None:
        """Has it fulfil a request; only while it is free."""
        if self._requests is None or not self.free:
            raise RuntimeError("the planner is at work: send when it is free")
        self._present = request
        self._watch = get_running_loop().call_later(self._rules.planning, self._kill)
        try:
            self._requests.send(request)
        except OSError:
            return  # it has died, as the loop will find out

    def receive(self, news: PlannerReady | RequestDone | None) -> None:
        """Takes what it says to the server; None: it has died."""
        if self._watch is not None:
            self._watch.cancel()
        present, self._present = self._present, None
        match news:
            case PlannerReady() | RequestDone():
                self.warm = True
                self._idle()
            case None:
                was_warm, self.warm = self.warm, False
                self.deaths += 1
                self.close()
                self.failed = not was_warm
                self._lost(present)
                if not self.failed:
                    self.start()

    def close(self) -> None:
        """Ends the processes."""
        if self._requests is not None:
            self._requests.close()
        self._kill()

    def _kill(self) -> None:
        for child in self._children:
            child.kill()
