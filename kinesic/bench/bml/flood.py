"""Floods a server by raw sockets, as hostile clients would; shares no code with it.

Started as a program, `python flood.py KIND PORT`, it floods until it is ended.
"""

import base64
import json
import os
import selectors
import socket
import sys
import time
from collections.abc import Callable, Iterator
from threading import Thread

FRAGMENTS, FLOODERS = (
    1_000_000,
    4,
)  # empty fragments of one message: 6 MB; connections that send such heaps side by side
DRIPPERS = 100  # connections that send single bytes
CROWD = 1000  # connections at once
BLOCKS = 40  # [1/s]
DOCUMENT = 4_000_000  # [bytes]
ROUNDS, REACHES = 8, 20  # [1/s] of questions; reaches in each
BLANKS = 400_000  # [bytes] that a question is longer than it need be
PLAN = '<bml id="asked"><gesture id="g" lexeme="BEAT" start="0"/></bml>'
GESTURE = 'category = "beat"\n[[gesture]]\nid = "flood"\nkeys = [{ right = { at = [0.5, %.2f, 0.5] } }]\n'
PAUSE = 0.01  # [s] after a failure
HERE = "127.0.0.1"


def send_fragments(port: int) -> None:
    """One WebSocket message of empty fragments, six bytes each, again and again."""
    while True:
        try:
            with socket.create_connection((HERE, port), 5.0) as client:
                key = base64.b64encode(os.urandom(16)).decode()
                client.sendall(
                    f"GET / HTTP/1.1\r\nHost: {HERE}:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                    f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
                )
                client.recv(4096)
                client.sendall(b"\x01\x80\0\0\0\0" + b"\x00\x80\0\0\0\0" * FRAGMENTS)
        except OSError:
            time.sleep(PAUSE)


def send_drips(port: int) -> None:
    """A message that never ends, byte after byte, on many connections."""
    clients: list[socket.socket] = []
    while True:
        while len(clients) < DRIPPERS:
            try:
                client = socket.create_connection((HERE, port), 5.0)
                client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                client.setblocking(False)
                client.send(b"<")
                clients.append(client)
            except OSError:
                time.sleep(PAUSE)
        for client in tuple(clients):
            try:
                client.send(b"x")
            except BlockingIOError:
                continue
            except OSError:
                client.close()
                clients.remove(client)


def open_connections(port: int) -> None:
    """A thousand connections that say nothing; whichever is closed is opened anew."""
    waiting = selectors.DefaultSelector()
    present = dict[int, socket.socket]()
    while True:
        while len(present) < CROWD:
            client = socket.socket()
            client.setblocking(False)
            try:
                client.connect_ex((HERE, port))
                waiting.register(client, selectors.EVENT_READ)
                present[client.fileno()] = client
            except OSError:
                client.close()
                time.sleep(PAUSE)
        for key, _ in waiting.select(1.0):
            client = present[key.fd]
            try:
                gone = not client.recv(4096)
            except BlockingIOError:
                continue
            except OSError:
                gone = True
            if gone:
                waiting.unregister(client)
                del present[key.fd]
                client.close()


def send_blocks(port: int) -> None:
    """Forty small blocks a second."""
    number = 0
    while True:
        try:
            with socket.create_connection((HERE, port), 5.0) as client:
                Thread(target=_drain, args=(client,), daemon=True).start()
                while True:
                    number += 1
                    block = f'<bml id="flood{number}"><gesture id="g" lexeme="BEAT" start="0"/></bml>'
                    client.sendall(block.encode() + b"\0")
                    time.sleep(1.0 / BLOCKS)
        except OSError:
            time.sleep(PAUSE)


def send_documents(port: int) -> None:
    """Documents of four megabytes."""
    head = b'<bml id="large"><gesture id="g" lexeme="'
    document = head + b"x" * (DOCUMENT - len(head)) + b"\0"
    while True:
        try:
            with socket.create_connection((HERE, port), 5.0) as client:
                client.sendall(document)
                client.recv(4096)
        except OSError:
            time.sleep(PAUSE)


def send_questions(port: int) -> None:
    """All that may be asked, as fast as a client may: hands dragged, long plans, gestures, documents saved, opened."""
    number = 0
    while True:
        try:
            with socket.create_connection((HERE, port), 5.0) as client:
                Thread(target=_drain, args=(client,), daemon=True).start()
                client.sendall(_message(do="watch", rate=50))
                while True:
                    number += 1
                    client.sendall(b"".join(_questions(number)))
                    time.sleep(1.0 / ROUNDS)
        except OSError:
            time.sleep(PAUSE)


def _questions(number: int) -> Iterator[bytes]:
    """One round of them."""
    gesture = GESTURE % (0.2 + 0.01 * (number % 20))
    yield _message(do="plan", bml=PLAN + " " * BLANKS, id=number)
    yield _message(do="gesture", toml=gesture, id=number)
    yield _message(do="save", name=f"flood{number % 5}.toml", text=gesture, id=number)
    yield _message(do="save", name="flood.bml", text="\U0001f600" + " " * BLANKS, id=number)
    yield _message(do="open", name="flood.bml", id=number)
    yield _message(do="open", id=number)
    for k in range(REACHES):
        yield _message(do="reach", side="right", target=[0.05, 0.25, 0.2 + 0.02 * k], id=k)


def _message(**values: object) -> bytes:
    return json.dumps(values, ensure_ascii=False).encode() + b"\0"


def _drain(client: socket.socket) -> None:
    try:
        while client.recv(65_536):
            pass
    except OSError:
        return


FLOODS: dict[str, tuple[Callable[[int], None], int]] = {  # what is done, on how many threads
    "fragments": (send_fragments, FLOODERS),
    "drips": (send_drips, 1),
    "connections": (open_connections, 1),
    "blocks": (send_blocks, 1),
    "documents": (send_documents, FLOODERS),
    "questions": (send_questions, FLOODERS),
}


if __name__ == "__main__":
    flood, threads = FLOODS[sys.argv[1]]
    for _ in range(threads):
        Thread(target=flood, args=(int(sys.argv[2]),), daemon=True).start()
    while True:
        time.sleep(3600.0)
