"""Words that come one by one: how soon the body moves once the first phrase of a talk is whole.

A server runs in a process of its own, a client sends word by word over TCP. The first command is out when the block's
`start` is told, so that this message's arrival is an upper bound for it.
"""

import json
from collections.abc import Iterable
from math import inf
from time import monotonic, sleep

import numpy as np

from kinesic.bench.bml.server import open_server
from kinesic.bench.figure import Figure
from kinesic.client import Client

TALKS = 10
EVERY = 0.05  # [s] from word to word
CALM = 10.0  # [s] in which the next message has to come
GOAL = 400.0  # [ms]
PHRASES = (
    "Hello, my friend! ",
    "No, I did not say that. ",
    "There were three enormous boxes in the hall, ",
    "Everybody in the village described the long road to the river, ",
    "What can we do now? ",
)


def bench() -> Iterable[Figure]:
    """Measures talks of one phrase, one after the other."""
    with open_server() as server, Client(port=server.port) as client:
        found = [first_command(client, PHRASES[k % len(PHRASES)]) for k in range(TALKS)]
    slow = float(np.percentile(found, 95, method="higher"))
    yield Figure("meaning.phrase_to_command_p95", slow, "ms", GOAL, "lower", why=f"median {np.median(found):.0f}")


def first_command(client: Client, phrase: str) -> float:
    """Says a phrase word by word, and waits until it is performed.

    Returns:
        The time from the last word of the first block to its start [ms]; infinite where it does not begin.
    """
    sent = list[float]()
    for word in phrase.split():
        sent.append(monotonic())
        client.do("words", text=f"{word} ")
        sleep(EVERY)
    client.do("words", ends=True)
    found, first, last = inf, "", ""
    while (message := client.receive(CALM)) is not None:
        told = json.loads(message) if message.startswith("{") else {}
        if told.get("told") == "saying" and not first:
            first, said = told["block"], sent[len(told["text"].split()) - 1]
        elif told.get("told") == "all_said":
            last = told["block"]
        elif f' id="{first}:start"' in message and "<blockProgress" in message:
            found = 1000.0 * (monotonic() - said)
        if f' id="{last}:end"' in message and "<blockProgress" in message:
            break
    return found
