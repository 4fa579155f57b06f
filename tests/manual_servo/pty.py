"""Servos behind a pseudo-terminal in real time."""

import os
import select
import time
import tty
from math import inf

from .line import Line

POLL_PERIOD = 0.005  # [s] longest pause between two steps of the simulation without incoming bytes


class Port:
    """Pseudo-terminal whose other end is a wire."""

    def __init__(self, line: Line) -> None:
        self.line = line
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.path = os.ttyname(self._slave)
        self._began = time.monotonic() - line.world.time

    def serve(self, seconds: float = inf) -> None:
        """Transfer bytes to and from the wire for a time [s]."""
        end = self._now() + seconds
        while (now := self._now()) < end:
            self.line.world.advance(now)
            wait = min(POLL_PERIOD, max(0.0, self.line.arrives() - now))
            if select.select([self._master], [], [], wait)[0]:
                self.line.send(os.read(self._master, 4096), self._now())
            if came := self.line.receive(self._now()):
                os.write(self._master, came)

    def _now(self) -> float:
        return time.monotonic() - self._began

    def close(self) -> None:
        """Close the terminal."""
        os.close(self._master)
        os.close(self._slave)
