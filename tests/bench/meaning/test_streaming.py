import json
import socket
from threading import Thread
from time import monotonic, sleep

import pytest

from kinesic.bench.meaning.streaming import STREAMED_PHRASES, WORD_INTERVAL, measure_first_command
from kinesic.client import Client

ANSWER_DELAY = 0.3  # [s] delay of the server's answers
EARLY_PHRASE = "Yes, " + 15 * "word " + "end."
EARLY_SAYING = json.dumps({"told": "saying", "block": "said1-1", "text": "Yes,"})
SAYING = json.dumps({"told": "saying", "block": "said1-1", "text": "Hello my friend"})
ALL_SAID = json.dumps({"told": "all_said", "block": "said1-1"})
START_MESSAGE, END_MESSAGE = (
    f'<blockProgress xmlns="x" id="said1-1:{point}" globalTime="1"/>' for point in ("start", "end")
)


def answer(listener: socket.socket, received: list[str], answers: tuple[str, ...]) -> None:
    """Act as a server that sends given answers after the last word."""
    connection, _ = listener.accept()
    data = b""
    while b'"ends"' not in data:
        data += connection.recv(4096)
    received += [json.loads(part)["text"] for part in data.split(b"\0")[:-1] if b'"text"' in part]
    for message in answers:
        sleep(ANSWER_DELAY * (message is not SAYING))
        connection.sendall(message.encode() + b"\0")
    connection.close()


@pytest.mark.parametrize("answers", [(SAYING, START_MESSAGE, ALL_SAID, END_MESSAGE), (SAYING, ALL_SAID, END_MESSAGE)])
def test_delay_from_last_word_to_block_start_is_measured(answers):
    received: list[str] = []
    with socket.create_server(("127.0.0.1", 0)) as listener:
        server = Thread(target=answer, args=(listener, received, answers))
        server.start()
        with Client(port=listener.getsockname()[1]) as client:
            delay = measure_first_command(client, STREAMED_PHRASES[0])
        server.join(5.0)
    assert "".join(received) == STREAMED_PHRASES[0]
    if START_MESSAGE in answers:
        assert 1000 * (ANSWER_DELAY + WORD_INTERVAL) <= delay < 1000 * 2 * (ANSWER_DELAY + WORD_INTERVAL) + 1000
    else:
        assert delay == float("inf")


def answer_early(listener: socket.socket) -> None:
    """Act as a server that starts the block at the second word."""
    connection, _ = listener.accept()
    data, is_started = b"", False
    while b'"ends"' not in data:
        data += connection.recv(4096)
        if not is_started and data.count(b'"text"') >= len(EARLY_PHRASE.split()) // 2:
            connection.sendall(f"{EARLY_SAYING}\0{START_MESSAGE}\0".encode())
            is_started = True
    connection.sendall(f"{ALL_SAID}\0{END_MESSAGE}\0".encode())
    connection.close()


def test_first_command_delay_excludes_words_sent_after_the_block_start():
    with socket.create_server(("127.0.0.1", 0)) as listener:
        server = Thread(target=answer_early, args=(listener,))
        server.start()
        with Client(port=listener.getsockname()[1]) as client:
            began = monotonic()
            measured = measure_first_command(client, EARLY_PHRASE)
            elapsed = 1000.0 * (monotonic() - began)
        server.join(5.0)
    assert measured < 0.75 * elapsed  # the words after the start do not delay the measurement
