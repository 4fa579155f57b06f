import json
import socket
from threading import Thread
from time import sleep

import pytest

from kinesic.bench.meaning.streaming import EVERY, PHRASES, first_command
from kinesic.client import Client

LATE = 0.3  # [s] that the server takes to begin
SAYING = json.dumps({"told": "saying", "block": "said1-1", "text": "Hello my friend"})
ALL_SAID = json.dumps({"told": "all_said", "block": "said1-1"})
BEGINS, ENDS = (f'<blockProgress xmlns="x" id="said1-1:{point}" globalTime="1"/>' for point in ("start", "end"))


def answer(listener: socket.socket, heard: list[str], answers: tuple[str, ...]) -> None:
    """A server that tells what it is given to tell once it has been told that no more words come."""
    connection, _ = listener.accept()
    data = b""
    while b'"ends"' not in data:
        data += connection.recv(4096)
    heard += [json.loads(each)["text"] for each in data.split(b"\0")[:-1] if b'"text"' in each]
    for told in answers:
        sleep(LATE * (told is not SAYING))
        connection.sendall(told.encode() + b"\0")
    connection.close()


@pytest.mark.parametrize("told", [(SAYING, BEGINS, ALL_SAID, ENDS), (SAYING, ALL_SAID, ENDS)])
def test_the_time_from_the_end_of_the_phrase_to_the_start_of_its_block_is_measured(told):
    heard: list[str] = []
    with socket.create_server(("127.0.0.1", 0)) as listener:
        server = Thread(target=answer, args=(listener, heard, told))
        server.start()
        with Client(port=listener.getsockname()[1]) as client:
            found = first_command(client, PHRASES[0])
        server.join(5.0)
    assert "".join(heard) == PHRASES[0]
    if BEGINS in told:
        assert 1000 * (LATE + EVERY) <= found < 1000 * 2 * (LATE + EVERY) + 1000
    else:
        assert found == float("inf")
