"""The planning processes as the server sees them: one wish at a time, killed when they hang, and begun anew."""

from asyncio import TimerHandle, get_running_loop
from collections.abc import Callable
from multiprocessing.connection import Connection

from kinesic.child import Child, child_context
from kinesic.controller import perform
from kinesic.planning.setup import Setup
from kinesic.serve import planner, refiner
from kinesic.serve.clock import Clock
from kinesic.serve.loop import Loop
from kinesic.serve.messages import DocumentRequest, PlannerReady, RequestDone, Wanted
from kinesic.serve.quotas import Quotas


class Planner:
    """One process at a time; everything here happens in the server's asyncio loop."""

    def __init__(
        self,
        make_setup: Callable[[], Setup],
        loop: Loop,
        clock: Clock,
        *,
        rules: Quotas,
        idle: Callable[[], None],
        lost: Callable[[Wanted | None], None],
    ) -> None:
        """Not started yet.

        Args:
            make_setup: makes what planning needs, in the other process.
            loop: gets what is planned.
            clock: of everybody.
            rules: how large a document may be, and how long one wish may take.
            idle: called whenever it can take a wish.
            lost: called with what it was doing, when it has died; it is then started again, unless it failed.
        """
        self._make_setup, self._loop, self._clock, self._rules = make_setup, loop, clock, rules
        self._idle, self._lost = idle, lost
        self._children: list[Child] = []
        self._wishes: Connection | None = None
        self._watch: TimerHandle | None = None
        self._present: Wanted | None = None  # what it is doing
        self.warm = False
        self.deaths = 0  # so far
        self.failed = False  # it cannot even be started

    @property
    def free(self) -> bool:
        """Whether it waits for something to do."""
        return self.warm and self._present is None

    def serves(self, sender: int) -> bool:
        """Whether it plans a document of this sender."""
        return isinstance(self._present, DocumentRequest) and self._present.sender == sender

    def start(self) -> None:
        """Begins a process, which tells when it is warm."""
        slow = (planner.__name__, perform.__name__, self._make_setup.__module__)
        context = child_context(*slow)  # nothing of the server's threads
        there, self._wishes = context.Pipe(duplex=False)
        loop_end, planner_end = context.Pipe()
        improver_end, leisure_end = context.Pipe()
        beginning = self._loop.beginning()
        given = (self._make_setup, there, planner_end, leisure_end, self._clock, beginning, self._rules)
        self._children = [
            Child(context, planner.run_planner, *given, name="planner"),
            Child(context, refiner.run_refiner, self._make_setup, improver_end, name="improver"),
        ]
        self._loop.link(loop_end, beginning)

    def send(self, wanted: Wanted) -> None:
        """Has it do something; only while it is free."""
        if self._wishes is None or not self.free:
            raise RuntimeError("the planner is at work: send when it is free")
        self._present = wanted
        self._watch = get_running_loop().call_later(self._rules.planning, self._kill)
        try:
            self._wishes.send(wanted)
        except OSError:
            return  # it has died, as the loop will find out

    def heard(self, news: PlannerReady | RequestDone | None) -> None:
        """What came of it; None: it has died."""
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
        if self._wishes is not None:
            self._wishes.close()
        self._kill()

    def _kill(self) -> None:
        for child in self._children:
            child.kill()
