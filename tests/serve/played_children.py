"""Stub child processes that run in threads or not at all."""

import os
import socket
import threading
from collections.abc import Callable
from multiprocessing import Pipe
from types import SimpleNamespace

from kinesic.child import PipeEnd


class PlayedChild:
    """Stub child process that only records its arguments."""

    def __init__(self, context: object, work: Callable, *arguments: object, name: str | None = None) -> None:
        self.context, self.work, self.arguments, self.name = context, work, arguments, name
        self.is_alive = True
        self.kills: list[bool] = []  # whether each call waited
        self.waits = 0
        self.pipes = [argument for argument in arguments if isinstance(argument, PipeEnd)]

    def kill(self, *, wait: bool = True) -> None:
        self.kills.append(wait)
        self.is_alive = False
        for pipe in self.pipes:
            if not pipe.closed:
                with socket.socket(fileno=os.dup(pipe.fileno())) as end:
                    end.shutdown(socket.SHUT_RDWR)

    def wait(self, seconds: float | None = None) -> int | None:
        self.waits += 1
        return None


class ThreadChild(PlayedChild):
    """Stub child process whose work runs in a thread."""

    def __init__(self, context: object, work: Callable, *arguments: object, name: str | None = None) -> None:
        super().__init__(context, work, *arguments, name=name)
        self.thread = threading.Thread(target=work, args=arguments, daemon=True)
        self.thread.start()


def played_context(*preload: str) -> SimpleNamespace:
    """Return a context that records preloaded modules and directions of pipes."""
    directions: list[bool] = []

    def make_pipe(duplex: bool = True) -> tuple[PipeEnd, PipeEnd]:
        directions.append(duplex)
        return Pipe()

    return SimpleNamespace(Pipe=make_pipe, preload=preload, directions=directions)
