"""Floods of a server by raw sockets of hostile clients.

It has no code in common with the server.

Run as a program, `python flood.py KIND PORT` floods until it is killed.
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

EMPTY_FRAGMENTS = 1_000_000  # empty fragments per WebSocket message, 6 MB
FLOODING_THREADS = 4  # threads of a flood of fragments, documents or requests, with a connection each
DRIP_CONNECTIONS = 100  # connections that send single bytes
IDLE_CONNECTIONS = 1000  # simultaneous connections that send nothing
BLOCK_RATE = 40  # [1/s] small blocks sent to the server
DOCUMENT_SIZE = 4_000_000  # [bytes] size of each large document
QUESTION_ROUNDS = 8  # [1/s] rounds of client requests; a round has one request of each kind
REACHES_PER_ROUND = 20  # IK requests per round
BLANK_PADDING = 400_000  # [bytes] unnecessary blanks in a request
PLAN_BLOCK = '<bml id="asked"><gesture id="g" lexeme="BEAT" start="0"/></bml>'
GESTURE_TEMPLATE = 'category = "beat"\n[[gesture]]\nid = "flood"\nkeys = [{ right = { at = [0.5, %.2f, 0.5] } }]\n'
RETRY_PAUSE = 0.01  # [s] pause before a failed connection is opened again
LOCAL_HOST = "127.0.0.1"


def send_fragments(port: int) -> None:
    """Send WebSocket messages that consist of a million empty fragments.

    An empty fragment has six bytes.
    """
    while True:
        try:
            with socket.create_connection((LOCAL_HOST, port), 5.0) as client:
                key = base64.b64encode(os.urandom(16)).decode()
                client.sendall(
                    f"GET / HTTP/1.1\r\nHost: {LOCAL_HOST}:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                    f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
                )
                client.recv(4096)
                client.sendall(b"\x01\x80\0\0\0\0" + b"\x00\x80\0\0\0\0" * EMPTY_FRAGMENTS)
        except OSError:
            time.sleep(RETRY_PAUSE)


def send_drips(port: int) -> None:
    """Send an endless message byte by byte on many connections."""
    clients: list[socket.socket] = []
    while True:
        while len(clients) < DRIP_CONNECTIONS:
            try:
                client = socket.create_connection((LOCAL_HOST, port), 5.0)
                client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                client.setblocking(False)
                client.send(b"<")
                clients.append(client)
            except OSError:
                time.sleep(RETRY_PAUSE)
        for client in tuple(clients):
            try:
                client.send(b"x")
            except BlockingIOError:
                continue
            except OSError:
                client.close()
                clients.remove(client)


def open_connections(port: int) -> None:
    """Keep a thousand idle connections open, and reopen closed connections."""
    waiting = selectors.DefaultSelector()
    present = dict[int, socket.socket]()
    while True:
        while len(present) < IDLE_CONNECTIONS:
            client = socket.socket()
            client.setblocking(False)
            try:
                client.connect_ex((LOCAL_HOST, port))
                waiting.register(client, selectors.EVENT_READ)
                present[client.fileno()] = client
            except OSError:
                client.close()
                time.sleep(RETRY_PAUSE)
        for key, _ in waiting.select(1.0):
            client = present[key.fd]
            try:
                is_closed = not client.recv(4096)
            except BlockingIOError:
                continue
            except OSError:
                is_closed = True
            if is_closed:
                waiting.unregister(client)
                del present[key.fd]
                client.close()


def send_blocks(port: int) -> None:
    """Send `BLOCK_RATE` small BML blocks per second on one connection."""
    number = 0
    while True:
        try:
            with socket.create_connection((LOCAL_HOST, port), 5.0) as client:
                Thread(target=_drain, args=(client,), daemon=True).start()
                while True:
                    number += 1
                    block = f'<bml id="flood{number}"><gesture id="g" lexeme="BEAT" start="0"/></bml>'
                    client.sendall(block.encode() + b"\0")
                    time.sleep(1.0 / BLOCK_RATE)
        except OSError:
            time.sleep(RETRY_PAUSE)


def send_documents(port: int) -> None:
    """Send malformed BML documents of four megabytes, each on a new connection."""
    head = b'<bml id="large"><gesture id="g" lexeme="'
    document = head + b"x" * (DOCUMENT_SIZE - len(head)) + b"\0"
    while True:
        try:
            with socket.create_connection((LOCAL_HOST, port), 5.0) as client:
                client.sendall(document)
                client.recv(4096)
        except OSError:
            time.sleep(RETRY_PAUSE)


def send_questions(port: int) -> None:
    """Send client requests of every kind at a high rate.

    They drag hands, request long plans, edit gestures, and save and open documents.
    """
    number = 0
    while True:
        try:
            with socket.create_connection((LOCAL_HOST, port), 5.0) as client:
                Thread(target=_drain, args=(client,), daemon=True).start()
                client.sendall(_message(do="watch", rate=50))
                while True:
                    number += 1
                    client.sendall(b"".join(_list_requests(number)))
                    time.sleep(1.0 / QUESTION_ROUNDS)
        except OSError:
            time.sleep(RETRY_PAUSE)


def _list_requests(number: int) -> Iterator[bytes]:
    """Yield one round of client requests of every kind."""
    gesture = GESTURE_TEMPLATE % (0.2 + 0.01 * (number % 20))
    yield _message(do="plan", bml=PLAN_BLOCK + " " * BLANK_PADDING, id=number)
    yield _message(do="gesture", toml=gesture, id=number)
    yield _message(do="save", name=f"flood{number % 5}.toml", text=gesture, id=number)
    yield _message(do="save", name="flood.bml", text="\U0001f600" + " " * BLANK_PADDING, id=number)
    yield _message(do="open", name="flood.bml", id=number)
    yield _message(do="open", id=number)
    for k in range(REACHES_PER_ROUND):
        yield _message(do="reach", side="right", target=[0.05, 0.25, 0.2 + 0.02 * k], id=k)


def _message(**values: object) -> bytes:
    return json.dumps(values, ensure_ascii=False).encode() + b"\0"


def _drain(client: socket.socket) -> None:
    try:
        while client.recv(65_536):
            pass
    except OSError:
        return


FLOOD_FUNCTIONS: dict[str, tuple[Callable[[int], None], int]] = {  # flood function and number of threads, by name
    "fragments": (send_fragments, FLOODING_THREADS),
    "drips": (send_drips, 1),
    "connections": (open_connections, 1),
    "blocks": (send_blocks, 1),
    "documents": (send_documents, FLOODING_THREADS),
    "questions": (send_questions, FLOODING_THREADS),
}


if __name__ == "__main__":
    flood, threads = FLOOD_FUNCTIONS[sys.argv[1]]
    for _ in range(threads):
        Thread(target=flood, args=(int(sys.argv[2]),), daemon=True).start()
    while True:
        time.sleep(3600.0)
