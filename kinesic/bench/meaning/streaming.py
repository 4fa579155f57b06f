"""Benchmark of streamed text: delay from a phrase to its motion.

It measures delay from the first complete phrase to the first motion.

The server runs in a process of its own; a client sends word by word over TCP. The first command has been sent when the
block's `start` is reported, so this message's arrival is an upper bound of the delay.
"""

import json
from collections.abc import Iterable, Sequence
from math import inf
from time import monotonic

import numpy as np

from kinesic.bench.bml.server import open_server
from kinesic.bench.metric import Metric
from kinesic.client import Client

TALK_COUNT = 10  # streamed talks of one phrase each
WORD_INTERVAL = 0.05  # [s] interval between streamed words
MESSAGE_TIMEOUT = 10.0  # [s] time limit for the server's next message
MAX_DELAY = 200.0  # [ms] goal for the 95th percentile from phrase to first command
STREAMED_PHRASES = (
    "Hello, my friend! ",
    "No, I did not say that. ",
    "There were three enormous boxes in the hall, ",
    "Everybody in the village described the long road to the river, ",
    "What can we do now? ",
)


def bench() -> Iterable[Metric]:
    """Measure the delay from streamed phrases to their first command."""
    with open_server() as server, Client(port=server.port) as client:
        delays = [measure_first_command(client, STREAMED_PHRASES[k % len(STREAMED_PHRASES)]) for k in range(TALK_COUNT)]
    slow = float(np.percentile(delays, 95, method="higher"))
    yield Metric("meaning.phrase_to_command_p95", slow, "ms", MAX_DELAY, "lower", why=f"median {np.median(delays):.0f}")


def measure_first_command(client: Client, phrase: str) -> float:
    """Stream a phrase and return the delay [ms] until its motion starts.

    Returns:
        The time from the last word of the first block to its start [ms]; infinite if it does not start.
    """
    sent, messages = list[float](), list[tuple[str, float]]()
    for word in phrase.split():
        sent.append(monotonic())
        client.do("words", text=f"{word} ")
        while (rest := sent[-1] + WORD_INTERVAL - monotonic()) > 0.0:  # messages are dated while words are sent
            _receive(client, rest, messages)
    client.do("words", ends=True)
    last = ""
    while not any(f' id="{last}:end"' in message and "<blockProgress" in message for message, _ in messages):
        if not _receive(client, MESSAGE_TIMEOUT, messages):
            break
        reply = _read_reply(messages[-1][0])
        last = reply["block"] if reply.get("told") == "all_said" else last
    return _compute_delay(sent, messages)


def _receive(client: Client, timeout: float, messages: list[tuple[str, float]]) -> bool:
    """Append the next message with its time, and return whether one arrived."""
    message = client.receive(timeout)
    if message is not None:
        messages.append((message, monotonic()))
    return message is not None


def _compute_delay(sent: Sequence[float], messages: Iterable[tuple[str, float]]) -> float:
    """Return the first block's delay [ms] after its words, infinite without start.

    Args:
        sent: times of the words [s].
        messages: of the server, with their arrival times [s].
    """
    first, completed = "", 0.0
    for message, time in messages:
        reply = _read_reply(message)
        if reply.get("told") == "saying" and not first:
            first, completed = reply["block"], sent[len(reply["text"].split()) - 1]
        elif first and f' id="{first}:start"' in message and "<blockProgress" in message:
            return 1000.0 * (time - completed)
    return inf


def _read_reply(message: str) -> dict[str, str]:
    """Return the fields of a JSON message, empty for a BML message."""
    reply: dict[str, str] = json.loads(message) if message.startswith("{") else {}
    return reply
