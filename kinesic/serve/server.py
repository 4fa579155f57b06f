"""Server for clients over TCP, WebSocket and standard input.

It opens, runs until shutdown is requested, and folds the robot to rest.
"""

import sys
from asyncio import FIRST_COMPLETED, Event, create_task, sleep, timeout, wait
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from kinesic.heap import bound_heap
from kinesic.planning.setup import Setup
from kinesic.serve.address import Address
from kinesic.serve.clients import ClientRegistry
from kinesic.serve.desk.export import NO_WRITERS, Writers
from kinesic.serve.priority import raise_priority
from kinesic.serve.reception import Reception, serve_console
from kinesic.serve.session import Session
from kinesic.serve.sinks.real_time import RealTimeSink
from kinesic.serve.stop_lines import StopLines
from kinesic.serve.tracks import NO_ACCOMPANIMENT, SoundAndFace
from kinesic.serve.wire.origin import OPEN_ACCESS, Access
from kinesic.serve.wire.pages import NO_FILES, WebFile
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS, Quotas
from kinesic.serve.wire.transport import Console

THREAD_SWITCH_INTERVAL = 0.001  # [s] interval at which client threads and loop yield the interpreter lock
CLOSE_GOING_AWAY = 1001  # WebSocket close code: the server ends
FOLDING_TIMEOUT = 30.0  # [s] time limit to end all blocks and fold to rest
LOOP_POLL_PERIOD = 0.1  # [s] between two checks whether the loop thread is alive


@dataclass(frozen=True, eq=False)
class Serving:
    """Open server with its clients and its address."""

    clients: ClientRegistry
    reception: Reception
    address: Address | None  # None: only standard input


@asynccontextmanager
async def open_serving(
    make_setup: Callable[[], Setup],
    sinks: Sequence[RealTimeSink],
    *,
    address: Address | None,
    rules: Quotas = DEFAULT_QUOTAS,
    access: Access = OPEN_ACCESS,
    accompaniment: SoundAndFace = NO_ACCOMPANIMENT,
    files: Mapping[str, WebFile] = NO_FILES,
    folder: Path | None = None,
    writers: Writers = NO_WRITERS,
) -> AsyncIterator[Serving]:
    """Open a server within the context, once its planner is warm.

    Fold the robot at the end.

    Args:
        make_setup: creates the setup for planning; picklable, because another process calls it, too.
        sinks: sinks to drive, closed at the end.
        address: listening address; None for standard input only.
        rules: limits for clients.
        access: token and allowed origins.
        accompaniment: whether a sink shows the face and whether speech is audible.
        files: files for browsers, by path.
        folder: folder for documents of clients; None disables saving.
        writers: additional file writers for exports; picklable.

    Raises:
        ConfigError: the address is not available.
    """
    bound_heap()
    clients = ClientRegistry(
        rules,
        access,
        lambda registry: Session(
            make_setup, sinks, rules, registry.tell, accompaniment=accompaniment, folder=folder, writers=writers
        ),
    )
    stop_lines = StopLines(clients.session.emergency_stop, rules)
    reception = Reception(clients, stop_lines, files)
    sys.setswitchinterval(THREAD_SWITCH_INTERVAL)
    try:
        if address is not None:
            address = Address(address.host, reception.listen(address.host, address.port))
        await clients.session.start()
        stop_lines.open()
        reception.open()
        with raise_priority():  # only now, because child processes inherit the priority
            yield Serving(clients, reception, address)
        reception.close()
        with suppress(TimeoutError):
            async with timeout(FOLDING_TIMEOUT):
                await clients.session.fold()
    finally:
        reception.close()
        clients.close(CLOSE_GOING_AWAY, "the server ends")
        await reception.end()
        stop_lines.close()
        clients.session.close()


async def serve_until_done(
    open_: Serving,
    shutdown: Event,
    *,
    console: bool,
    ends_with_input: bool = False,
    make_console: Callable[[Quotas], Console] = Console,
) -> None:
    """Wait until shutdown is requested, the loop fails, or all input ends.

    Args:
        open_: the server.
        shutdown: event that requests the shutdown.
        console: whether standard input is read.
        ends_with_input: whether the end of standard input ends the server even if it also listens at an address.
        make_console: creates the reader of standard input with the limits for clients.
    """
    tasks = {create_task(shutdown.wait()), create_task(_wait_for_loop_end(open_.clients.session))}
    reading = create_task(serve_console(open_.clients, make_console)) if console else None
    if reading is not None and (open_.address is None or ends_with_input):
        tasks.add(reading)
    await wait(tasks, return_when=FIRST_COMPLETED)
    all_tasks = (*tasks, *((reading,) if reading else ()))
    for task in all_tasks:
        task.cancel()
    await wait(all_tasks)


async def _wait_for_loop_end(session: Session) -> None:
    while session.loop.is_alive():
        await sleep(LOOP_POLL_PERIOD)
