"""Messages over standard input and output."""

import asyncio
import json
import os
import threading
from collections.abc import Callable, Iterator
from types import SimpleNamespace

import pytest

from kinesic.serve.wire import transport
from kinesic.serve.wire.quotas import Quotas
from kinesic.serve.wire.transport import Console, WordConsole


@pytest.fixture
def type_text(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[bytes], None]]:
    """Write to standard input, and end it."""
    read_end, write_end = os.pipe()
    monkeypatch.setattr(transport.sys, "stdin", SimpleNamespace(fileno=lambda: read_end))

    def write(data: bytes) -> None:
        os.write(write_end, data)
        os.close(write_end)

    yield write
    for reader in (thread for thread in threading.enumerate() if thread.name == "stdin"):
        reader.join()  # it must not read from another file with the same descriptor
    os.close(read_end)


async def read(console: Console) -> list[bytes]:
    return [message async for message in console.messages(lambda: False)]


def test_end_of_the_console_input_ends_the_last_message(type_text: Callable[[bytes], None]) -> None:
    async def run() -> list[bytes]:
        type_text(b"<one/>\0\n<two/>\0<three/>")
        return await read(Console(Quotas()))

    assert asyncio.run(run()) == [b"<one/>", b"<two/>", b"<three/>"]


def test_console_input_after_the_event_loop_is_closed_is_ignored(type_text: Callable[[bytes], None]) -> None:
    async def start() -> None:
        Console(Quotas())

    asyncio.run(start())
    type_text(b"late")  # an exception in the reader thread fails the test


def test_overlong_console_message_is_refused(type_text: Callable[[bytes], None]) -> None:
    async def run() -> list[bytes]:
        type_text(b"x" * 11)
        return await read(Console(Quotas(message=10)))

    with pytest.raises(ValueError, match="at most 10 are read"):
        asyncio.run(run())


def test_console_prints_one_answer_per_line_even_after_close(type_text: Callable[[bytes], None], capfd) -> None:
    async def run() -> None:
        type_text(b"")
        console = Console(Quotas())
        assert console.lingers
        await console.send("one")
        await console.close(1000, "unused")
        await console.send("two")

    asyncio.run(run())
    assert capfd.readouterr().out == "one\ntwo\n"


def test_server_ends_although_nobody_reads_its_standard_output(
    type_text: Callable[[bytes], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    (reader, writer), is_printed, others = os.pipe(), list[bool](), {*threading.enumerate()}
    monkeypatch.setattr(transport.sys, "stdout", SimpleNamespace(fileno=lambda: writer))

    async def run() -> None:
        type_text(b"")
        sending = asyncio.create_task(Console(Quotas()).send("x" * 1_000_000))
        await asyncio.sleep(0.05)
        is_printed.append(sending.done())

    server = threading.Thread(target=asyncio.run, args=(run(),), daemon=True)
    server.start()
    server.join(30)
    is_running = server.is_alive()
    os.close(reader)
    for printer in (thread for thread in {*threading.enumerate()} - others if thread.name == "stdout"):
        printer.join()  # its write fails, as the pipe has no reader
    os.close(writer)
    assert (is_printed, is_running) == ([False], False)


def test_console_reports_a_closed_standard_output(
    type_text: Callable[[bytes], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    monkeypatch.setattr(transport.sys, "stdout", SimpleNamespace(fileno=lambda: writer))

    async def run() -> None:
        type_text(b"")
        await Console(Quotas()).send("x")

    with pytest.raises(BrokenPipeError):
        asyncio.run(run())
    os.close(writer)


def test_words_typed_on_the_console_are_sent_in_chunks_followed_by_an_end_message(
    type_text: Callable[[bytes], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    pauses: list[float] = []
    monkeypatch.setattr(transport, "CHUNK_SIZE", 7)  # within the umlaut

    async def note_pause(seconds: float) -> None:
        pauses.append(seconds)

    monkeypatch.setattr(transport, "sleep", note_pause)
    shown: list[str] = []

    async def run() -> list[bytes]:
        type_text("Guten Übermut".encode())
        console = WordConsole(Quotas(rate=4.0), shown.append)
        messages = await read(console)
        await console.send("answer")
        return messages

    messages = [json.loads(message) for message in asyncio.run(run())]
    assert "".join(message["text"] for message in messages) == "Guten Übermut"
    assert {message["do"] for message in messages} == {"words"}
    assert [message.get("ends", False) for message in messages] == [False] * (len(messages) - 1) + [True]
    assert pauses == [0.25] * (len(messages) - 1)
    assert shown == ["answer"]
