"""The server: clients come by TCP, WebSocket and standard input, and each is attended to by itself.

It opens, waits until its end is requested, and folds the robot to rest.
"""

import sys
from asyncio import FIRST_COMPLETED, Event, create_task, sleep, timeout, wait
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from kinesic.heap import bound_heap
from kinesic.planning.setup import Setup
from kinesic.serve.clients import ClientRegistry
from kinesic.serve.desk.export import NO_WRITERS, Writers
from kinesic.serve.priority import urgent
from kinesic.serve.reception import Reception, attend_console
from kinesic.serve.session import Session
from kinesic.serve.sinks.real_time import RealTimeSink
from kinesic.serve.stop_lines import StopLines
from kinesic.serve.tracks import SILENT, SoundAndFace
from kinesic.serve.wire.origin import ANYBODY_HERE, Access
from kinesic.serve.wire.pages import NO_FILES, WebFile
from kinesic.serve.wire.quotas import USUAL, Quotas
from kinesic.serve.wire.transport import Console

SWITCH = 0.001  # [s] after which clients and the loop take the interpreter from each other
AWAY = 1001  # WebSocket's code of a server that ends
FOLDING = 30.0  # [s] that ending everything and coming to rest may take
LOOK_AT_LOOP = 0.1  # [s] between two looks at whether the loop still runs


@dataclass(frozen=True)
class Address:
    """Where a server listens."""

    host: str
    port: int  # 0: any that is free

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


@dataclass(frozen=True, eq=False)
class Serving:
    """An open server: its clients and its address."""

    clients: ClientRegistry
    reception: Reception
    address: Address | None  # None: only standard input


@asynccontextmanager
async def open_serving(
    make_setup: Callable[[], Setup],
    sinks: Sequence[RealTimeSink],
    *,
    address: Address | None,
    rules: Quotas = USUAL,
    access: Access = ANYBODY_HERE,
    accompaniment: SoundAndFace = SILENT,
    files: Mapping[str, WebFile] = NO_FILES,
    folder: Path | None = None,
    writers: Writers = NO_WRITERS,
) -> AsyncIterator[Serving]:
    """Opens a server once its planner is warm, and folds the robot to rest at the end.

    Args:
        make_setup: makes what planning needs; picklable, because another process calls it too.
        sinks: sinks, closed at the end.
        address: to listen at; None: nowhere.
        rules: what clients may do.
        access: who may connect.
        accompaniment: whether one of the sinks shows the face, and whether speech is heard.
        files: that browsers may have, by their path.
        folder: where clients keep documents; None: nowhere.
        writers: of files that clients may ask for beside those that are known here; picklable.

    Raises:
        ConfigError: the address cannot be had.
    """
    bound_heap()
    clients = ClientRegistry(
        rules,
        access,
        lambda own: Session(
            make_setup, sinks, rules, own.tell, accompaniment=accompaniment, folder=folder, writers=writers
        ),
    )
    stop_lines = StopLines(clients.session.halt, rules)
    reception = Reception(clients, stop_lines, files)
    sys.setswitchinterval(SWITCH)
    try:
        if address is not None:
            address = Address(address.host, reception.listen(address.host, address.port))
        await clients.session.start()
        stop_lines.open()
        reception.open()
        with urgent():  # not before: planners are ordinary processes, and begin with what this thread has
            yield Serving(clients, reception, address)
        reception.close()
        with suppress(TimeoutError):
            async with timeout(FOLDING):
                await clients.session.fold()
    finally:
        reception.close()
        clients.close(AWAY, "the server ends")
        await reception.end()
        stop_lines.close()
        clients.session.close()


async def until_done(
    open_: Serving,
    enough: Event,
    *,
    console: bool,
    ends_with_input: bool = False,
    make_console: Callable[[Quotas], Console] = Console,
) -> None:
    """Wait until the end is requested, the loop fails, or all input ends.

    Args:
        open_: the server.
        enough: set by whoever requests the end.
        console: whether standard input is read.
        ends_with_input: whether the end of standard input ends the server although other clients may come.
        make_console: makes what reads it, by the rules of clients.
    """
    tasks = {create_task(enough.wait()), create_task(_failed(open_.clients.session))}
    reading = create_task(attend_console(open_.clients, make_console)) if console else None
    if reading is not None and (open_.address is None or ends_with_input):
        tasks.add(reading)
    await wait(tasks, return_when=FIRST_COMPLETED)
    ending = (*tasks, *((reading,) if reading else ()))
    for task in ending:
        task.cancel()
    await wait(ending)


async def _failed(session: Session) -> None:
    while session.loop.is_alive():
        await sleep(LOOK_AT_LOOP)
