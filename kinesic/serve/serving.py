"""A server as a whole: it opens, waits until somebody wants it to end, and folds the robot to rest."""

from asyncio import FIRST_COMPLETED, Event, create_task, sleep, timeout, wait
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass

from kinesic.planning.setup import Facts
from kinesic.serve.desk import Desk
from kinesic.serve.quotas import USUAL, Rules
from kinesic.serve.server import attend_console, listen
from kinesic.serve.session import Performer
from kinesic.serve.sinks import Follower

AWAY = 1001  # WebSocket's code of a server that ends
FOLDING = 30.0  # [s] that ending everything and coming to rest may take
LOOK = 0.1  # [s] between two looks at whether the loop still runs


@dataclass(frozen=True)
class Address:
    """Where a server listens."""

    host: str
    port: int  # 0: any that is free

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


@dataclass(frozen=True, eq=False)
class Serving:
    """An open server."""

    desk: Desk
    address: Address | None  # None: only standard input


@asynccontextmanager
async def serving(
    facts_of: Callable[[], Facts],
    followers: Sequence[Follower],
    *,
    address: Address | None,
    rules: Rules = USUAL,
    token: str | None = None,
    face: bool = False,
    sound: bool = False,
) -> AsyncIterator[Serving]:
    """Opens a server once its planner is warm, and folds the robot to rest at the end.

    Args:
        facts_of: makes what planning needs; picklable, because another process calls it too.
        followers: sinks, closed at the end.
        address: to listen at; None: nowhere.
        rules: what clients may do.
        token: that clients must show.
        face: one of the sinks shows it.
        sound: speech is heard.

    Raises:
        ConfigError: the address cannot be had.
    """
    desk = Desk(rules, token, lambda own: Performer(facts_of, followers, rules, own.tell, face=face, sound=sound))
    listener = None
    try:
        if address is not None:
            listener = await listen(desk, address.host, address.port)
            address = Address(address.host, listener.sockets[0].getsockname()[1])
        await desk.performer.start()
        if listener is not None:
            await listener.start_serving()
        yield Serving(desk, address)
        if listener is not None:
            listener.close()
        with suppress(TimeoutError):
            async with timeout(FOLDING):
                await desk.performer.fold()
    finally:
        if listener is not None:
            listener.close()
        desk.close(AWAY, "the server ends")
        await sleep(LOOK)  # for what is still to be read
        desk.performer.close()


async def until_done(open_: Serving, wanted: Event, *, console: bool) -> None:
    """Waits until somebody wants the end, the loop has failed, or nothing can come any more.

    Args:
        open_: the server.
        wanted: set by whoever wants the end.
        console: whether standard input is read.
    """
    tasks = {create_task(wanted.wait()), create_task(_failed(open_.desk.performer))}
    reading = create_task(attend_console(open_.desk)) if console else None
    if reading is not None and open_.address is None:
        tasks.add(reading)
    await wait(tasks, return_when=FIRST_COMPLETED)
    for task in (*tasks, *((reading,) if reading else ())):
        task.cancel()


async def _failed(performer: Performer) -> None:
    while performer.loop.is_alive():
        await sleep(LOOK)
