"""Benchmark of streamed text: delay from a phrase to its motion.

It measures delay from the first complete phrase to the first motion.

The server runs in a process of its own; a client sends word by word over TCP. The first command has been sent when the
block's `start` is reported, so this message's arrival is an upper bound of the delay.
"""

import json
from collections.abc import Iterable
from math import inf
from time import monotonic, sleep

import numpy as np

from kinesic.bench.bml.server import open_server
from kinesic.bench.metric import Metric
from kinesic.client import Client

TALK_COUNT = 10  # streamed talks of one phrase each
WORD_INTERVAL = 0.05  # [s] between streamed words
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
    """Stream a phrase and measure the delay from word to motion start.

    Returns:
        The time from the last word of the first block to its start [ms]; infinite if it does not start.
    """
    sent = list[float]()
    for word in phrase.split():
        sent.append(monotonic())
        client.do("words", text=f"{word} ")
        sleep(WORD_INTERVAL)
    client.do("words", ends=True)
    delay, first, last = inf, "", ""
    while (message := client.receive(MESSAGE_TIMEOUT)) is not None:
        reply = json.loads(message) if message.startswith("{") else {}
        if reply.get("told") == "saying" and not first:
            first, last_word = reply["block"], sent[len(reply["text"].split()) - 1]
        elif reply.get("told") == "all_said":
            last = reply["block"]
        elif f' id="{first}:start"' in message and "<blockProgress" in message:
            delay = 1000.0 * (monotonic() - last_word)
        if f' id="{last}:end"' in message and "<blockProgress" in message:
            break
    return delay
