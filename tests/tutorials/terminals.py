"""Terminals in which the commands of a tutorial run, one process group each."""

import os
import signal
import subprocess
import time
from pathlib import Path
from threading import Thread

from tests.tutorials.outputs import matches

COMMAND_TIMEOUT = 90.0  # [s] longest wait for a command or its shown output, sufficient on a busy machine
POLL_PERIOD = 0.05  # [s] between two comparisons of the output


class TutorialError(AssertionError):
    """Command that failed, or output that differs from the page."""


class Terminal:
    """Terminal that runs one block of commands at a time."""

    def __init__(self, folder: Path, environment: dict[str, str]) -> None:
        self._folder, self._environment = folder, environment
        self._process: subprocess.Popen[str] | None = None
        self._source, self._shown, self._printed = "", "", list[str]()
        self._is_measured = False  # [s] longest time for a command or its shown output, also on a loaded machine
        self._reader: Thread | None = None  # [s] time between two comparisons of the output

    @property
    def printed(self) -> str:
        """Output of the last block of commands until now."""
        return "".join(self._printed)

    def start(self, source: str) -> None:
        """Run a block of commands after ending the previous block by Ctrl-C."""
        self.interrupt()
        self._printed = printed = list[str]()
        self._source, self._shown = source, ""
        self._process = process = subprocess.Popen(
            ["bash", "-e", "-c", source],
            cwd=self._folder,
            env=self._environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        assert process.stdout is not None
        self._reader = Thread(target=lambda lines=process.stdout: printed.extend(lines))
        self._reader.start()

    def press_enter(self) -> None:
        """Press Enter in this terminal."""
        assert self._process is not None
        assert self._process.stdin is not None
        self._process.stdin.write("\n")
        self._process.stdin.flush()

    def await_output(self, shown: str, *, is_measured: bool) -> None:
        """Wait until the output matches the shown output.

        Args:
            shown: text of the page.
            is_measured: whether its decimals depend on the machine.

        Raises:
            TutorialError: it is not, at the end of the commands or of the time limit.
        """
        self._shown, self._is_measured, end = shown, is_measured, time.monotonic() + COMMAND_TIMEOUT
        while self._is_running() and time.monotonic() < end:
            if matches(f"{shown.rstrip()}...", self.printed, is_measured=is_measured):
                return
            time.sleep(POLL_PERIOD)
        if not self._is_running() and self._reader is not None:
            self._reader.join()
        self._compare()

    def await_end(self) -> None:
        """Wait until the commands have ended.

        Raises:
            TutorialError: a command failed, does not end, or printed more than is shown.
        """
        if self._process is None:
            return
        try:
            code = self._process.wait(COMMAND_TIMEOUT)
        except subprocess.TimeoutExpired:
            raise TutorialError(f"{self._source}\ndoes not end; it printed\n\n{self.printed}") from None
        self._close()
        if code:
            raise TutorialError(f"{self._source}\nended with {code} and printed\n\n{self.printed}")
        self._compare()

    def _compare(self) -> None:
        if self._shown and not matches(self._shown, self.printed, is_measured=self._is_measured):
            raise TutorialError(f"{self._source}\nprinted\n\n{self.printed}\nbut the page shows\n\n{self._shown}")

    def interrupt(self) -> None:
        """Press Ctrl-C if the commands still run, and wait for their end."""
        if self._process is None:
            return
        if self._is_running():
            self._shown = ""  # the page shows nothing after Ctrl-C
            os.killpg(self._process.pid, signal.SIGINT)
        self.await_end()

    def kill(self) -> None:
        """Kill all processes of the terminal."""
        if self._process is not None:
            if self._is_running():
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
            self._close()

    def _is_running(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def _close(self) -> None:
        assert self._process is not None
        assert self._reader is not None
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.close()
        self._reader.join()
        self._process.stdout.close()
        self._process = None
