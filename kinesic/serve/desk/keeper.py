"""Saves and opens documents of clients, each client's in order, in a thread of its own; gestures only once tried."""

from asyncio import Future, Lock, Task, create_task, get_running_loop
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from kinesic.body.config import ConfigError
from kinesic.serve.desk.asker import Asker
from kinesic.serve.desk.documents import GESTURE_SUFFIX, DocumentFolder
from kinesic.serve.desk.drafter import SOUND, DraftQuestion, FileQuestion, took_too_long
from kinesic.serve.desk.helper import Helper, Unanswered
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.questions import OpenRequest, SaveRequest
from kinesic.serve.wire.quotas import Quotas

MOST_WAITING = 16  # requests of one client

Request = SaveRequest | OpenRequest
T = TypeVar("T")


@dataclass(eq=False)
class _Line:
    """Requests of one client."""

    lock: Lock = field(default_factory=Lock)  # held by the one that is fulfilled
    count: int = 0


class DocumentKeeper:
    """Does what clients want with the folder."""

    def __init__(
        self,
        folder: Path | None,
        drafter: Helper[DraftQuestion],
        rules: Quotas,
        on_gestures_saved: Callable[[], Awaitable[None]],
    ) -> None:
        """Begins with nobody waiting.

        Args:
            folder: where documents are kept; None: nowhere.
            drafter: tries gestures before they are kept.
            rules: how long that may take.
            on_gestures_saved: returns when they will be known to whatever comes next.
        """
        self._folder, self._drafter, self._rules = DocumentFolder(folder), drafter, rules
        self._on_gestures_saved = on_gestures_saved
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="documents")
        self._lines: dict[int, _Line] = {}  # by client
        self._tasks: set[Task[None]] = set()

    def take(self, asker: Asker, request: Request) -> None:
        """Fulfils a request when those that this client has made before are."""
        line = self._lines.setdefault(asker.number, _Line())
        if line.count >= MOST_WAITING:
            asker.send(_refusal(request, f"{MOST_WAITING} of your documents wait already; wait for their answers"))
            return
        line.count += 1
        task = create_task(self._fulfil(asker, request, line))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def close(self) -> None:
        """Fulfils nothing more."""
        for task in self._tasks:
            task.cancel()
        self._thread.shutdown(wait=False, cancel_futures=True)

    async def _fulfil(self, asker: Asker, request: Request, line: _Line) -> None:
        try:
            async with line.lock:
                asker.send(await self._answer(asker, request))
        except (ConfigError, OSError) as error:
            asker.send(_refusal(request, str(error)))
        finally:
            line.count -= 1
            if not line.count:
                del self._lines[asker.number]

    async def _answer(self, asker: Asker, request: Request) -> str:
        if isinstance(request, OpenRequest):
            return await self._in_thread(lambda: self._open(request))
        if request.name.endswith(GESTURE_SUFFIX):
            await self._save_gestures(asker.number, request)
        else:
            await self._in_thread(lambda: self._folder.save(request.name, request.text))
        return json_answer("saved", id=request.id, name=request.name)

    async def _save_gestures(self, client: int, request: SaveRequest) -> None:
        """Keeps a file of gestures, if it is one, and replaces none that holds anything else.

        Raises:
            ConfigError: it is not kept.
        """
        present = await self._in_thread(lambda: self._folder.read_present(request.name))
        found: Future[str | Unanswered] = get_running_loop().create_future()
        question = FileQuestion(request.name, request.text, present)
        self._drafter.ask(client, question, found.set_result, kind="file")
        fault = await found
        if fault != SOUND:
            raise ConfigError(
                f"{request.name}: {took_too_long(self._rules) if isinstance(fault, Unanswered) else fault}"
            )
        await self._in_thread(lambda: self._folder.save(request.name, request.text))
        self._drafter.renew()
        await self._on_gestures_saved()

    def _open(self, request: OpenRequest) -> str:
        if request.name is not None:
            text = self._folder.read(request.name)
            return json_answer("document", id=request.id, name=request.name, text=text)
        found = self._folder.list()
        return json_answer("documents", id=request.id, names=found.names, whole=found.is_whole)

    async def _in_thread(self, act: Callable[[], T]) -> T:
        return await get_running_loop().run_in_executor(self._thread, act)


def _refusal(request: Request, why: str) -> str:
    verb = "save" if isinstance(request, SaveRequest) else "open"
    return json_answer("refused", do=verb, id=request.id, why=why)
