"""Saving and opening of documents with a stub drafter: order and validation."""

import asyncio
import json
from collections.abc import Callable, Coroutine
from pathlib import Path

import pytest

from kinesic.serve.desk.drafter import NO_FAULT, FileQuestion
from kinesic.serve.desk.helper import Unanswered
from kinesic.serve.desk.keeper import MAX_WAITING_REQUESTS, DocumentKeeper
from kinesic.serve.desk.requester import Requester
from kinesic.serve.wire.questions import (
    BackupRequest,
    BackupsRequest,
    OpenRequest,
    SaveRequest,
    StorageRequest,
    VersionsRequest,
)
from kinesic.serve.wire.quotas import Quotas

RULES = Quotas(planning=7.0)


class Drafter:
    """Stub drafter that answers its questions only when the test lets it."""

    def __init__(self) -> None:
        self.questions: list[tuple[int, FileQuestion, str]] = []
        self.replies: list[Callable] = []
        self.renewals = 0
        self.always: str | Unanswered | None = None

    def ask(self, client: int, question: FileQuestion, reply: Callable, *, kind: str = "") -> None:
        self.questions.append((client, question, kind))
        self.replies.append(reply)
        if self.always is not None:
            reply(self.always)

    def renew(self) -> None:
        self.renewals += 1


class Office:
    """Document keeper with its drafter and the messages to clients."""

    def __init__(self, folder: Path | None) -> None:
        self.drafter, self.told, self.known = Drafter(), list[tuple[int, dict]](), 0
        self.keeper = DocumentKeeper(folder, self.drafter, RULES, self.become_known)

    async def become_known(self) -> None:
        self.known += 1

    def take(self, request: StorageRequest, client: int = 1) -> None:
        self.keeper.take(Requester(client, lambda said: self.told.append((client, json.loads(said))), bool), request)

    async def finish(self, count: int) -> list[dict]:
        """Wait for a number of answers."""
        async with asyncio.timeout(20.0):
            while len(self.told) < count:
                await asyncio.sleep(0.001)
        return [said for _, said in self.told]

    async def asked(self, count: int) -> None:
        async with asyncio.timeout(20.0):
            while len(self.drafter.questions) < count:
                await asyncio.sleep(0.001)


@pytest.fixture
def work(tmp_path: Path) -> Callable:
    def run(act: Callable[[Office], Coroutine], *, folder: Path | None = tmp_path) -> None:
        async def whole() -> None:
            office = Office(folder)
            try:
                await act(office)
            finally:
                office.keeper.close()

        asyncio.run(whole())

    return run


def test_document_is_saved_opened_and_listed(work: Callable, tmp_path: Path):
    async def act(office: Office) -> None:
        office.take(SaveRequest("a.bml", "<bml/>", id=3))
        office.take(OpenRequest("a.bml", id=4))
        office.take(OpenRequest(id=5))
        saved, document, documents = await office.finish(3)
        revision = saved.pop("revision")
        assert saved == {"told": "saved", "id": 3, "name": "a.bml"}
        assert document == {"told": "document", "id": 4, "name": "a.bml", "text": "<bml/>", "revision": revision}
        assert documents == {"told": "documents", "id": 5, "names": ["a.bml"], "whole": True}
        assert not office.drafter.questions
        assert office.known == office.drafter.renewals == 0

    work(act)
    assert (tmp_path / "a.bml").read_text() == "<bml/>"


@pytest.mark.parametrize(
    ("request_", "verb", "why"),
    [
        (SaveRequest("../a.bml", "x", id=3), "save", "not a document name"),
        (OpenRequest("gone.bml", id=3), "open", "no such document"),
    ],
)
def test_impossible_save_or_open_request_is_refused_and_the_next_one_executed(
    work: Callable, request_: SaveRequest | OpenRequest, verb: str, why: str
):
    async def act(office: Office) -> None:
        office.take(request_)
        office.take(OpenRequest(id=9))
        refused, listed = await office.finish(2)
        assert (refused["told"], refused["do"], refused["id"]) == ("refused", verb, 3)
        assert why in refused["why"]
        assert listed["id"] == 9

    work(act)


def test_save_requests_without_a_document_folder_are_refused(work: Callable):
    async def act(office: Office) -> None:
        office.take(SaveRequest("a.bml", "x"))
        assert "--folder" in (await office.finish(1))[0]["why"]

    work(act, folder=None)


def test_gesture_file_is_validated_saved_and_loaded_before_the_answer(work: Callable, tmp_path: Path):
    (tmp_path / "a.toml").write_text("before")

    async def act(office: Office) -> None:
        office.take(SaveRequest("a.toml", "after", id=3), client=5)
        await office.asked(1)
        assert office.drafter.questions == [(5, FileQuestion("a.toml", "after", "before"), "file")]
        assert (tmp_path / "a.toml").read_text() == "before"
        office.drafter.replies[0](NO_FAULT)
        (answer,) = await office.finish(1)
        assert answer.pop("revision")
        assert answer == {"told": "saved", "id": 3, "name": "a.toml"}
        assert office.known == office.drafter.renewals == 1

    work(act)
    assert (tmp_path / "a.toml").read_text() == "after"


def test_new_gesture_file_is_validated_without_previous_content_and_saved(work: Callable, tmp_path: Path):
    async def act(office: Office) -> None:
        office.drafter.always = NO_FAULT
        office.take(SaveRequest("a.toml", "new"))
        await office.finish(1)
        assert office.drafter.questions[0][1].present is None

    work(act)
    assert (tmp_path / "a.toml").read_text() == "new"


@pytest.mark.parametrize(
    ("fault", "why"),
    [
        ("it has robot", "a.toml: it has robot"),
        (Unanswered.FAILED, "a.toml: planning failed, or took longer than 7 s"),
        (Unanswered.OUTDATED, "a.toml: planning failed, or took longer than 7 s"),
    ],
)
def test_invalid_gesture_file_is_not_saved(work: Callable, tmp_path: Path, fault: str | Unanswered, why: str):
    async def act(office: Office) -> None:
        office.drafter.always = fault
        office.take(SaveRequest("a.toml", "x", id=3))
        (answer,) = await office.finish(1)
        assert answer["told"] == "refused"
        assert answer["why"].startswith(why)
        assert office.known == office.drafter.renewals == 0

    work(act)
    assert not (tmp_path / "a.toml").exists()


def test_document_requests_are_executed_in_order_per_client_and_independently_between_clients(
    work: Callable, tmp_path: Path
):
    async def act(office: Office) -> None:
        office.take(SaveRequest("a.toml", "x", id=1), client=1)
        office.take(OpenRequest(id=2), client=1)
        await office.asked(1)
        office.take(OpenRequest(id=3), client=2)
        ((client, answer),) = [office.told[0] for _ in await office.finish(1)]
        assert (client, answer["id"]) == (2, 3)
        office.drafter.replies[0](NO_FAULT)
        await office.finish(3)
        assert [(client, said["id"]) for client, said in office.told] == [(2, 3), (1, 1), (1, 2)]

    work(act)


def test_number_of_waiting_document_requests_per_client_is_limited(work: Callable):
    async def act(office: Office) -> None:
        office.take(SaveRequest("a.toml", "x"))
        for number in range(1, MAX_WAITING_REQUESTS):
            office.take(OpenRequest(id=number))
        assert not office.told
        office.take(OpenRequest(id=99))
        ((_, refused),) = office.told
        assert (refused["told"], refused["id"]) == ("refused", 99)
        assert f"{MAX_WAITING_REQUESTS} of your document requests are pending" in refused["why"]
        office.take(OpenRequest(id=7), client=2)
        await office.finish(2)
        assert office.told[1][0] == 2
        await office.asked(1)
        office.drafter.replies[0](NO_FAULT)
        await office.finish(2 + MAX_WAITING_REQUESTS)
        office.take(OpenRequest(id=100))
        await office.finish(3 + MAX_WAITING_REQUESTS)
        assert office.told[-1][1]["told"] == "documents"

    work(act)


def test_document_requests_are_not_executed_after_the_keeper_is_closed(work: Callable, tmp_path: Path):
    async def act(office: Office) -> None:
        office.take(SaveRequest("a.toml", "x"))
        await office.asked(1)
        office.keeper.close()
        await asyncio.sleep(0)
        assert not office.drafter.renewals

    work(act)
    assert not (tmp_path / "a.toml").exists()


def test_document_is_not_replaced_by_a_request_with_an_outdated_revision(work: Callable, tmp_path: Path):
    async def act(office: Office) -> None:
        office.drafter.always = NO_FAULT
        for name in ("a.bml", "a.toml"):
            (tmp_path / name).write_text("theirs")
            office.take(SaveRequest(name, "mine", revision="", id=3))
        for refused in await office.finish(2):
            assert (refused["told"], refused["do"], refused["conflict"]) == ("refused", "save", True)
            assert "exists already" in refused["why"]
        assert not office.drafter.questions, "a file that is not saved is not validated"
        office.take(OpenRequest("a.toml"))
        revision = (await office.finish(3))[2]["revision"]
        office.take(SaveRequest("a.toml", "mine", revision=revision))
        assert (await office.finish(4))[3]["told"] == "saved"

    work(act)
    assert (tmp_path / "a.bml").read_text() == "theirs"
    assert (tmp_path / "a.toml").read_text() == "mine"


def test_earlier_versions_of_a_replaced_document_are_listed_and_read(work: Callable):
    async def act(office: Office) -> None:
        for text in ("one", "two", "three"):
            office.take(SaveRequest("a.bml", text))
        office.take(VersionsRequest("a.bml", id=7))
        office.take(VersionsRequest("a.bml", 1, id=8))
        office.take(VersionsRequest("a.bml", 9))
        office.take(VersionsRequest("../a.bml"))
        *_, listed, read, missing, outside = await office.finish(7)
        assert [version["number"] for version in listed["versions"]] == [2, 1]
        assert read == {"told": "version", "id": 8, "name": "a.bml", "number": 1, "text": "one"}
        assert (missing["told"], missing["do"]) == ("refused", "versions")
        assert "no version 9; there are: 2, 1" in missing["why"]
        assert "not a document name" in outside["why"]

    work(act)


def test_backup_is_stored_listed_read_and_discarded(work: Callable):
    async def act(office: Office) -> None:
        office.take(BackupRequest("k" * 8, "a.bml", "text", "r1", time=12.5, id=1))
        assert await office.finish(1) == [{"told": "backed_up", "id": 1, "key": "k" * 8}]
        office.take(BackupsRequest(id=2))
        office.take(BackupsRequest("k" * 8, id=3))
        _, listed, read = await office.finish(3)
        assert listed["backups"] == [{"key": "k" * 8, "name": "a.bml", "revision": "r1", "time": 12.5}]
        assert (read["told"], read["text"], read["revision"], read["id"]) == ("backup", "text", "r1", 3)
        office.take(BackupRequest("k" * 8))
        await office.finish(4)
        office.take(BackupsRequest())
        assert (await office.finish(5))[4]["backups"] == []

    work(act)


def test_backup_does_not_wait_for_the_validation_of_gestures(work: Callable):
    async def act(office: Office) -> None:
        office.take(SaveRequest("a.toml", "x", id=1))
        await office.asked(1)
        office.take(BackupRequest("k" * 8, "b.bml", "text", id=2))
        assert (await office.finish(1))[0]["told"] == "backed_up"
        office.drafter.replies[0](NO_FAULT)
        await office.finish(2)

    work(act)
