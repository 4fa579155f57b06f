"""The face as a sink: a window, or pictures that nobody sees, drawn in a process of its own."""

import multiprocessing
import time
from dataclasses import replace
from multiprocessing.connection import Connection
from types import TracebackType

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.child import Child
from kinesic.face.display import DisplayError
from kinesic.face.render.head_pose import turns
from kinesic.face.show.preview_settings import PreviewSettings
from kinesic.face.show.shared_command import SharedCommand, ShownFace
from kinesic.face.show.window import has_display

OPENING = 60.0  # [s] that the process has to draw its first picture
PACE = 0.01  # [s] between two commands that are put up; faster ones are passed over
CLOSING = 10.0  # [s] that it has for the last one
PLAIN = PreviewSettings()
UPRIGHT = (0.0, 0.0, 0.0)


class Preview:
    """Draws the newest command's face; it drops frames, and never holds up the performance.

    A closed window, or a process that ended, changes nothing for whoever plays.
    """

    def __init__(
        self,
        robot: Robot | None = None,
        *,
        look: PreviewSettings = PLAIN,
        windowed: bool | None = None,
    ) -> None:
        """Opens the window, and waits until the first picture is drawn.

        Args:
            robot: whose head turns the face; None: it looks ahead.
            look: how it begins; keys change it.
            windowed: whether a window is opened; None: where there is a display.

        Raises:
            DisplayError: nothing can be drawn here.
        """
        context = multiprocessing.get_context("spawn")
        look = replace(look, windowed=has_display() if windowed is None else windowed)
        self._robot, self._shared = robot, SharedCommand(context)
        self._number, self._last, self._waiting = 0, -PACE, False
        here, there = context.Pipe(duplex=False)
        self._child = Child(context, _show_face, self._shared, there, look)
        with here:
            why = _answer(here)
        if why:
            self._child.kill()
            raise DisplayError(why)

    @property
    def closed(self) -> bool:
        """Whether somebody closed the window, or nothing is drawn any more for another reason."""
        return not self._child.is_alive

    def write(self, command: Command) -> None:
        """Shows a command's face; one that comes too fast to be seen waits for a later one.

        Raises:
            DisplayError: an unknown action unit, or an intensity outside 0..1.
        """
        self._number += 1
        self._command = command
        now = time.perf_counter()
        self._waiting = now - self._last < PACE or not self._put()
        if not self._waiting:
            self._last = now

    def wait(self) -> None:
        """Waits until somebody has closed the window."""
        self._child.wait()

    def close(self) -> None:
        """Shows the last command, and closes the window."""
        if self._waiting and not self.closed:
            self._put(wait=True)
        self._shared.end()
        if self._child.wait(CLOSING) is None:
            self._child.kill()

    def _put(self, *, wait: bool = False) -> bool:
        command, turn = self._command, UPRIGHT
        if self._robot is not None:
            left, up, over = turns(self._robot, command.angles).tolist()
            turn = (left, up, over)
        return self._shared.write(ShownFace(self._number, command.time, turn, command.face), wait=wait)

    def __enter__(self) -> "Preview":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _show_face(shared: SharedCommand, answer: Connection, look: PreviewSettings) -> None:
    """Draws in the process that was begun: there alone is imported what draws, which takes half a second."""
    from kinesic.face.show.process import show_face  # noqa: PLC0415 - as said

    show_face(shared, answer, look)


def _answer(pipe: Connection) -> str:
    """Waits for the first picture; what hinders it, or nothing."""
    if not pipe.poll(OPENING):
        return f"nothing was drawn within {OPENING:g} s"
    try:
        return str(pipe.recv())
    except EOFError:
        return "the process that draws ended; `kinesic doctor` tells what works here"
