"""kinesic as a realizer in virtual time: documents go in, feedback comes out, no clock is waited for.

Time stands still while a block is planned.
"""

from collections.abc import Callable

from kinesic.bench.bml.heard import Feedback, heard
from kinesic.bml.block import BmlError
from kinesic.planning.setup import Facts
from kinesic.realizer.contention import among
from kinesic.realizer.realizer import Due, Scene, begun, passed, ready
from kinesic.realizer.request import Message, asked, refused


class Realizer:
    """One performer, from its rest at time 0."""

    def __init__(self, facts: Facts) -> None:
        self.feedback = Feedback()
        self.now = 0.0  # [s]
        self._facts, self._scene = facts, Scene.of(facts)

    def send(self, text: bytes | str, *, source: str = "<text>") -> None:
        """Sends a document now; one that is refused is answered by a warning."""
        message = Message(text, source=source)
        try:
            known = asked(message, self._facts, around=self._scene.around(self.now))
            coming = ready(among(self._scene, known), self._facts)
        except BmlError as error:
            self.feedback.messages.append(heard(refused(message, error)))
            return
        self._scene, due = begun(self._scene, coming, self.now)
        self._hear(due)

    def wait(self, seconds: float) -> None:
        """Lets time pass [s]."""
        self._pass(self.now + seconds)

    def wait_until(self, done: Callable[[Feedback], bool], *, timeout: float) -> bool:
        """Lets time pass from message to message until something was heard; False: it was not, in so many seconds."""
        end = self.now + timeout
        while not done(self.feedback):
            coming = self._scene.agenda[0].time if self._scene.agenda else end
            if coming >= end:
                self._pass(end)
                return done(self.feedback)
            self._pass(max(coming, self.now))
        return True

    def _pass(self, time: float) -> None:
        self.now = time
        self._scene, due = passed(self._scene, time)
        self._hear(due)

    def _hear(self, due: tuple[Due, ...]) -> None:
        self.feedback.messages += [heard(each.xml) for each in due]
