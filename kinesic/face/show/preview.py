"""Output of a performance that shows the face in a separate process.

It opens a window if there is a display.
"""

import multiprocessing
import time
from dataclasses import replace
from types import TracebackType

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.child import Child, PipeEnd
from kinesic.face.display import DisplayError
from kinesic.face.render.head_pose import compute_head_turns
from kinesic.face.show.preview_settings import PreviewSettings
from kinesic.face.show.shared_command import SharedCommand, ShownFace
from kinesic.face.show.window import has_display

OPENING_TIMEOUT = 60.0  # [s] longest wait for the first picture
MIN_WRITE_INTERVAL = 0.01  # [s] smallest time between two displayed commands; commands in between are skipped
CLOSING_TIMEOUT = 10.0  # [s] longest wait for the preview process to end
DEFAULT_SETTINGS = PreviewSettings()
UPRIGHT_TURN = (0.0, 0.0, 0.0)  # [rad] head rotation of an upright head


class Preview:
    """Output of a performance that draws the face of the newest command.

    It drops frames and never delays the performance. A closed window, or a process that ended, has no effect on the
    performance.
    """

    def __init__(
        self,
        robot: Robot | None = None,
        *,
        look: PreviewSettings = DEFAULT_SETTINGS,
        windowed: bool | None = None,
    ) -> None:
        """Start the preview process and wait for its first picture.

        Args:
            robot: robot whose head turns the face; None: the face looks ahead.
            look: initial settings; keys change them.
            windowed: whether to open a window; None: if there is a display.

        Raises:
            DisplayError: nothing can be drawn here.
        """
        context = multiprocessing.get_context("spawn")
        look = replace(look, windowed=has_display() if windowed is None else windowed)
        self._robot, self._shared = robot, SharedCommand(context)
        self._number, self._last, self._waiting = 0, -MIN_WRITE_INTERVAL, False
        here, there = context.Pipe(duplex=False)
        self._child = Child(context, _show_face, self._shared, there, look)
        with here:
            why = _wait_for_answer(here)
        if why:
            self._child.kill()
            raise DisplayError(why)

    @property
    def closed(self) -> bool:
        """Whether the preview window was closed or drawing has ended."""
        return not self._child.is_alive

    def write(self, command: Command) -> None:
        """Show a command's face, or skip commands that come too fast.

        Raises:
            DisplayError: an unknown action unit, or an intensity outside 0..1.
        """
        self._number += 1
        self._command = command
        now = time.perf_counter()
        self._waiting = now - self._last < MIN_WRITE_INTERVAL or not self._put()
        if not self._waiting:
            self._last = now

    def wait(self) -> None:
        """Wait until the preview window is closed."""
        self._child.wait()

    def close(self) -> None:
        """Show the last command's face and close the window."""
        if self._waiting and not self.closed:
            self._put(wait=True)
        self._shared.end()
        if self._child.wait(CLOSING_TIMEOUT) is None:
            self._child.kill()

    def _put(self, *, wait: bool = False) -> bool:
        command, turn = self._command, UPRIGHT_TURN
        if self._robot is not None:
            left, up, over = compute_head_turns(self._robot, command.angles).tolist()
            turn = (left, up, over)
        return self._shared.write(ShownFace(self._number, command.time, turn, command.face), wait=wait)

    def __enter__(self) -> "Preview":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _show_face(shared: SharedCommand, answer: PipeEnd, look: PreviewSettings) -> None:
    """Draw the preview in the child process.

    Only the child imports the renderer, which takes 0.5 s.
    """
    from kinesic.face.show.process import show_face  # noqa: PLC0415 - slow to import

    show_face(shared, answer, look)


def _wait_for_answer(pipe: PipeEnd) -> str:
    """Wait for the preview's first picture, and return an error text.

    The text is empty without an error.
    """
    if not pipe.poll(OPENING_TIMEOUT):
        return f"nothing was drawn within {OPENING_TIMEOUT:g} s"
    try:
        return str(pipe.recv())
    except EOFError:
        return "the process that draws ended; `kinesic doctor` shows what works here"
