"""Asynchronous saving and opening of client documents, their versions and backups.

Requests of one client are executed in sequence in a separate thread. Gesture files are validated before they are saved.
Backups do not wait for validations.
"""

from asyncio import Future, Lock, Task, create_task, get_running_loop
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TypeVar

import msgspec

from kinesic.body.config import ConfigError
from kinesic.serve.desk.backups import BackupFolder
from kinesic.serve.desk.documents import GESTURE_SUFFIX, DocumentFolder, RevisionError
from kinesic.serve.desk.drafter import NO_FAULT, DraftQuestion, FileQuestion, timeout_message
from kinesic.serve.desk.helper import Helper, Unanswered
from kinesic.serve.desk.requester import Requester
from kinesic.serve.desk.style_file import MAX_STYLE_SIZE, StyleEntry, is_style, list_builtin_styles
from kinesic.serve.wire.protocol import json_answer
from kinesic.serve.wire.questions import (
    BackupRequest,
    BackupsRequest,
    OpenRequest,
    SaveRequest,
    StorageRequest,
    StylesRequest,
    VersionsRequest,
)
from kinesic.serve.wire.quotas import Quotas

MAX_STYLE_FILES = 200  # largest number of files that are searched for styles
MAX_WAITING_REQUESTS = 16  # largest number of pending document requests, and of pending backups, of one client

T = TypeVar("T")  # type of an action's result


@dataclass(eq=False)
class _RequestQueue:
    """Lock and number of the pending requests of one client."""

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
        self._backups = BackupFolder(folder)
        self._on_gestures_saved = on_gestures_saved
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="documents")
        self._queues: dict[tuple[int, bool], _RequestQueue] = {}  # by client, separate for backups
        self._tasks: set[Task[None]] = set()

    def take(self, requester: Requester, request: StorageRequest) -> None:
        """Execute a request after the earlier ones in its client's queue.

        Each client has one queue for backup requests, and one for all others.

        Refuse it if `MAX_WAITING_REQUESTS` of this client are pending.
        """
        line = (requester.number, isinstance(request, BackupRequest))
        queue = self._queues.setdefault(line, _RequestQueue())
        if queue.count >= MAX_WAITING_REQUESTS:
            requester.send(
                _refusal(
                    request,
                    f"{MAX_WAITING_REQUESTS} of your document requests are pending already; wait for their answers",
                )
            )
            return
        queue.count += 1
        task = create_task(self._execute(requester, request, line))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def close(self) -> None:
        """Cancel all requests."""
        for task in self._tasks:
            task.cancel()
        self._thread.shutdown(wait=False, cancel_futures=True)

    async def _execute(self, requester: Requester, request: StorageRequest, line: tuple[int, bool]) -> None:
        queue = self._queues[line]
        try:
            async with queue.lock:
                requester.send(await self._answer(requester, request))
        except RevisionError as error:
            requester.send(_refusal(request, str(error), conflict=True))
        except (ConfigError, OSError) as error:
            requester.send(_refusal(request, str(error)))
        finally:
            queue.count -= 1
            if not queue.count:
                del self._queues[line]

    async def _answer(self, requester: Requester, request: StorageRequest) -> str:
        match request:
            case OpenRequest():
                return await self._in_thread(lambda: self._open(request))
            case VersionsRequest():
                return await self._in_thread(lambda: self._open_version(request))
            case StylesRequest():
                return await self._in_thread(lambda: self._list_styles(request))
            case BackupRequest():
                return await self._in_thread(lambda: self._back_up(request))
            case BackupsRequest():
                return await self._in_thread(lambda: self._open_backup(request))
            case SaveRequest(name, text, revision):
                if name.endswith(GESTURE_SUFFIX):
                    saved = await self._save_gestures(requester.number, request)
                else:
                    saved = await self._in_thread(lambda: self._folder.save(name, text, revision))
                return json_answer("saved", id=request.id, name=name, revision=saved)

    async def _save_gestures(self, client: int, request: SaveRequest) -> str:
        """Validate and save a gesture or style file, and return its revision.

        Never overwrite other content.

        Raises:
            ConfigError: the file is not saved.
        """
        await self._in_thread(lambda: self._folder.check_revision(request.name, request.revision))
        present = await self._in_thread(lambda: self._folder.read_present(request.name))
        answer: Future[str | Unanswered] = get_running_loop().create_future()
        question = FileQuestion(request.name, request.text, present)
        self._drafter.ask(client, question, answer.set_result, kind="file")
        fault = await answer
        if fault != NO_FAULT:
            raise ConfigError(
                f"{request.name}: {timeout_message(self._rules) if isinstance(fault, Unanswered) else fault}"
            )
        saved = await self._in_thread(lambda: self._folder.save(request.name, request.text, request.revision))
        self._drafter.renew()
        await self._on_gestures_saved()
        return saved

    def _open(self, request: OpenRequest) -> str:
        if request.name is not None:
            document = self._folder.read(request.name)
            return json_answer(
                "document", id=request.id, name=request.name, text=document.text, revision=document.revision
            )
        listing = self._folder.list()
        return json_answer("documents", id=request.id, names=listing.names, whole=listing.is_whole)

    def _open_version(self, request: VersionsRequest) -> str:
        name, number = request.name, request.number
        if number is None:
            versions = [asdict(version) for version in self._folder.list_versions(name)]
            return json_answer("versions", id=request.id, name=name, versions=versions)
        text = self._folder.read_version(name, number)
        return json_answer("version", id=request.id, name=name, number=number, text=text)

    def _back_up(self, request: BackupRequest) -> str:
        if request.text is None:
            self._backups.discard(request.key)
        else:
            self._backups.keep(request.key, request.name, request.revision, request.text, time=request.time)
        return json_answer("backed_up", id=request.id, key=request.key)

    def _open_backup(self, request: BackupsRequest) -> str:
        if request.key is None:
            return json_answer("backups", id=request.id, backups=self._backups.list())
        backup = self._backups.read(request.key)
        return json_answer("backup", id=request.id, **msgspec.structs.asdict(backup.header), text=backup.text)

    def _list_styles(self, request: StylesRequest) -> str:
        """Answer with the built-in styles and those of the folder."""
        names = [name for name in self._folder.list().names if name.endswith(GESTURE_SUFFIX)]
        styles = [entry.as_json() for entry in list_builtin_styles()]
        for name in names[:MAX_STYLE_FILES]:
            with suppress(ConfigError):  # a file that another program has changed may be invalid
                text = self._folder.read(name).text
                if len(text) <= MAX_STYLE_SIZE and is_style(text):
                    styles.append(StyleEntry(name.removesuffix(GESTURE_SUFFIX), text, is_own=True).as_json())
        return json_answer("styles", id=request.id, styles=styles)

    async def _in_thread(self, action: Callable[[], T]) -> T:
        return await get_running_loop().run_in_executor(self._thread, action)


def _refusal(request: StorageRequest, why: str, *, conflict: bool = False) -> str:
    return json_answer(
        "refused", do=request.__struct_config__.tag, id=request.id, why=why, **({"conflict": True} if conflict else {})
    )
