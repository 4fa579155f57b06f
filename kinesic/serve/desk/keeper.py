"""Asynchronous saving and opening of client documents.

Requests of one client are executed in sequence in a separate thread. Gesture files are validated before they are saved.
"""

from asyncio import Future, Lock, Task, create_task, get_running_loop
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from kinesic.body.config import ConfigError
from kinesic.serve.desk.documents import GESTURE_SUFFIX, DocumentFolder
from kinesic.serve.desk.drafter import NO_FAULT, DraftQuestion, FileQuestion, timeout_message
from kinesic.serve.desk.helper import Helper, Unanswered
from kinesic.serve.desk.requester import Requester
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.questions import OpenRequest, SaveRequest
from kinesic.serve.wire.quotas import Quotas

MAX_WAITING_REQUESTS = 16  # largest number of pending document requests of one client

Request = SaveRequest | OpenRequest
T = TypeVar("T")


@dataclass(eq=False)
class _RequestQueue:
    """Pending requests of one client."""

    lock: Lock = field(default_factory=Lock)  # held by the request in progress
    count: int = 0


class DocumentKeeper:
    """Executor of all clients' requests to save and open documents."""

    def __init__(
        self,
        folder: Path | None,
        drafter: Helper[DraftQuestion],
        rules: Quotas,
        on_gestures_saved: Callable[[], Awaitable[None]],
    ) -> None:
        """Create an executor without requests.

        Args:
            folder: folder for documents; None disables saving.
            drafter: process that validates gesture files.
            rules: limits with the time for a validation.
            on_gestures_saved: returns when the planner is about to use saved gestures.
        """
        self._folder, self._drafter, self._rules = DocumentFolder(folder), drafter, rules
        self._on_gestures_saved = on_gestures_saved
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="documents")
        self._queues: dict[int, _RequestQueue] = {}  # by client
        self._tasks: set[Task[None]] = set()

    def take(self, requester: Requester, request: Request) -> None:
        """Execute a request after all earlier ones of the same client.

        Refuse it if `MAX_WAITING_REQUESTS` of this client are pending.
        """
        queue = self._queues.setdefault(requester.number, _RequestQueue())
        if queue.count >= MAX_WAITING_REQUESTS:
            requester.send(
                _refusal(
                    request,
                    f"{MAX_WAITING_REQUESTS} of your document requests are pending already; wait for their answers",
                )
            )
            return
        queue.count += 1
        task = create_task(self._execute(requester, request, queue))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def close(self) -> None:
        """Cancel all requests."""
        for task in self._tasks:
            task.cancel()
        self._thread.shutdown(wait=False, cancel_futures=True)

    async def _execute(self, requester: Requester, request: Request, queue: _RequestQueue) -> None:
        try:
            async with queue.lock:
                requester.send(await self._answer(requester, request))
        except (ConfigError, OSError) as error:
            requester.send(_refusal(request, str(error)))
        finally:
            queue.count -= 1
            if not queue.count:
                del self._queues[requester.number]

    async def _answer(self, requester: Requester, request: Request) -> str:
        if isinstance(request, OpenRequest):
            return await self._in_thread(lambda: self._open(request))
        if request.name.endswith(GESTURE_SUFFIX):
            await self._save_gestures(requester.number, request)
        else:
            await self._in_thread(lambda: self._folder.save(request.name, request.text))
        return json_answer("saved", id=request.id, name=request.name)

    async def _save_gestures(self, client: int, request: SaveRequest) -> None:
        """Validate and save a gesture file.

        Never overwrite other content.

        Raises:
            ConfigError: the file is not saved.
        """
        present = await self._in_thread(lambda: self._folder.read_present(request.name))
        answer: Future[str | Unanswered] = get_running_loop().create_future()
        question = FileQuestion(request.name, request.text, present)
        self._drafter.ask(client, question, answer.set_result, kind="file")
        fault = await answer
        if fault != NO_FAULT:
            raise ConfigError(
                f"{request.name}: {timeout_message(self._rules) if isinstance(fault, Unanswered) else fault}"
            )
        await self._in_thread(lambda: self._folder.save(request.name, request.text))
        self._drafter.renew()
        await self._on_gestures_saved()

    def _open(self, request: OpenRequest) -> str:
        if request.name is not None:
            text = self._folder.read(request.name)
            return json_answer("document", id=request.id, name=request.name, text=text)
        listing = self._folder.list()
        return json_answer("documents", id=request.id, names=listing.names, whole=listing.is_whole)

    async def _in_thread(self, action: Callable[[], T]) -> T:
        return await get_running_loop().run_in_executor(self._thread, action)


def _refusal(request: Request, why: str) -> str:
    verb = "save" if isinstance(request, SaveRequest) else "open"
    return json_answer("refused", do=verb, id=request.id, why=why)
