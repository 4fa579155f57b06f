"""Load a server with six clients, and record feedback and memory.

Every kind of deed, question and flood comes first within four minutes, and at the same rate until the end. All
processes thus begin before memory counts, and growth afterwards is growth (the rule is in `memory_log`).

Started as a program, `python -m tests.soak.crowd SECONDS [OPTIONS OF SERVE]`, it prints both.
"""

import json
import random
import sys
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from itertools import cycle
from socket import create_connection
from subprocess import DEVNULL, Popen
from threading import Event, Thread
from time import monotonic

from kinesic.bench.bml import flood
from kinesic.bench.bml.server import Server, open_server
from kinesic.client import Client
from tests.soak.feedback_journal import FeedbackJournal
from tests.soak.memory_log import WARM_UP_TIME, MemoryLog

CLIENT_COUNT = 6
SAMPLE_PERIOD = 5.0  # [s] time between two samples of memory
MEAN_PAUSE = 1.2  # [s] mean time between two blocks, stops or interruptions of a client
CLOCK_QUERY_PERIOD = 2.0  # [s] time between two queries of the server's time
FLOOD_DURATION = 4.0  # [s] duration of one flood
FLOOD_PERIOD = 30.0  # [s] time between two floods; with five kinds in turn, each kind comes every 150 s
QUESTION_PERIOD = 12.0  # [s] time between two queries of one client
END_TIMEOUT = 40.0  # [s] time limit for the end of the last blocks
COMPOSITIONS = ("MERGE", "MERGE", "APPEND", "APPEND", "REPLACE")
BEHAVIOURS = (
    '<head id="h" lexeme="NOD" start="0.1" repetition="2"/>',
    '<gesture id="g" lexeme="BEAT" start="0.1"/>',
    '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND" stroke="0.9"/><head id="h" lexeme="SHAKE" start="0.5"/>',
    '<gaze id="z" target="left" start="0" end="1.5"/>',
    '<gazeShift id="z" target="right" start="0.1" end="0.9"/>',
    '<speech id="s"><text>Yes, <sync id="m"/>indeed.</text></speech><head id="h" lexeme="NOD" stroke="s:m"/>',
    "".join(f'<gesture id="g{k}" lexeme="BEAT" stroke="{1 + 0.9 * k:g}"/>' for k in range(5)),
    '<faceLexeme id="f" lexeme="SMILE" amount="0.8" start="0" end="1"/>',
)
QUESTIONS: tuple[tuple[str, dict[str, object]], ...] = (
    ("plan", {"bml": '<bml id="asked"><gesture id="g" lexeme="BEAT" start="0"/></bml>'}),
    ("reach", {"side": "right", "target": [0.05, 0.25, 0.3]}),
    ("gesture", {"toml": flood.GESTURE_TEMPLATE % 0.3}),
    ("export", {"format": "csv", "bml": '<bml id="asked"><head id="h" lexeme="NOD" start="0"/></bml>'}),
)
FAULT_WORDS = (
    "duplicate",
    "lost",
    "no end",
    "disorder",
    "early",
)  # words with which the feedback journal names kinds of faults
BLOCK_BML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}" composition="{}">{}</bml>'


@dataclass
class Report:
    """Faults of feedback, and memory of the server over time."""

    blocks: int
    messages: int
    faults: list[str]
    memory: MemoryLog


class _Member(Thread):
    """Client that sends blocks, stops and interruptions, and reads all feedback."""

    def __init__(self, number: int, port: int, done: Event) -> None:
        super().__init__(name=f"client {number}", daemon=True)
        self.number, self.journal = number, FeedbackJournal()
        self.is_complete = False  # whether the client has read its last feedback
        self._port, self._done = port, done
        self._chance = random.Random(number)
        self._asked: dict[int, float] = {}
        self._questions = cycle(QUESTIONS[number % len(QUESTIONS) :] + QUESTIONS[: number % len(QUESTIONS)])

    def run(self) -> None:
        with Client(port=self._port) as client:
            coming = asking = questioning = 0.0
            while not self._done.is_set():
                now = monotonic()
                if now >= asking:
                    asking = now + CLOCK_QUERY_PERIOD
                    self._asked[len(self._asked) + 1] = monotonic()
                    client.do("status", id=len(self._asked))
                if now >= coming:
                    coming = now + self._chance.expovariate(1.0 / MEAN_PAUSE)
                    self._act(client)
                if now >= questioning:
                    questioning = now + QUESTION_PERIOD
                    verb, values = next(self._questions)
                    client.do(verb, **values)
                self._hear(client, min(asking, coming, questioning))
            client.do("interrupt")
            self._hear(client, monotonic() + END_TIMEOUT, quiet=8.0)
        self.is_complete = True

    def faults(self) -> Iterator[str]:
        """Yield violations of the feedback rules, and a premature end."""
        if not self.is_complete:
            yield f"{self.name}: lost, it ended before its time"
        yield from self.journal.faults()

    def _act(self, client: Client) -> None:
        deed = self._chance.random()
        if deed < 0.03:
            client.do("stop")
            client.do("resume")
        elif deed < 0.08 and self.journal.sent:
            client.do("interrupt", block=self.journal.sent[-1])
        elif deed < 0.10:
            client.do("interrupt")
        elif deed < 0.14 and self.journal.sent:
            client.do("style", style=self._chance.choice(("calm", "neutral")), block=self.journal.sent[-1])
        else:
            name = f"c{self.number}n{len(self.journal.sent)}"
            self.journal.sent.append(name)
            client.send(BLOCK_BML.format(name, self._chance.choice(COMPOSITIONS), self._chance.choice(BEHAVIOURS)))

    def _hear(self, client: Client, until: float, quiet: float = 1e9) -> None:
        last = monotonic()
        while (left := min(until, last + quiet) - monotonic()) > 0.0:
            message = client.receive(left)
            if message is None:
                continue
            last = received = monotonic()
            if message.startswith("{"):
                data = json.loads(message)
                if data.get("told") == "status":
                    last -= 1e-3
                    self.journal.synchronize(self._asked[data["id"]], data["time"])
            else:
                self.journal.hear(message, received)


def crowd(server: Server, seconds: float) -> Report:
    """Load a server with clients, floods and unfinished connections for some time [s]."""
    done = Event()
    members = [_Member(number, server.port, done) for number in range(CLIENT_COUNT)]
    memory = MemoryLog()
    began = monotonic()
    with ExitStack() as closing:
        closing.callback(done.set)
        for each in members:
            each.start()
        hostile = Thread(target=_annoy, args=(server.port, done), daemon=True)
        hostile.start()
        while (time := monotonic() - began) < seconds and server.process.poll() is None:
            memory.record(round(time, 2), server.process.pid)
            done.wait(max(0.0, min(SAMPLE_PERIOD, seconds - (monotonic() - began))))
    for each in members:
        each.join(END_TIMEOUT + 10.0)
    hostile.join(20.0)
    exit_code = server.process.poll()
    ended = [] if exit_code is None else [f"lost, the server ended with exit code {exit_code}"]
    return Report(
        blocks=sum(len(member.journal.sent) for member in members),
        messages=sum(len(member.journal.arrivals) for member in members),
        faults=[*ended, *(fault for member in members for fault in member.faults())],
        memory=memory,
    )


def _annoy(port: int, done: Event) -> None:
    """Flood the server periodically, and leave connections with incomplete messages."""
    kinds = [kind for kind in flood.FLOOD_FUNCTIONS if kind != "blocks"]
    number = 0
    while not done.wait(FLOOD_PERIOD / 2):
        for _ in range(20):
            with suppress(OSError), create_connection(("127.0.0.1", port), 5.0) as half:
                half.sendall(b'<bml id="half')
        if done.wait(FLOOD_PERIOD / 2):
            return
        with Popen(
            [sys.executable, flood.__file__, kinds[number % len(kinds)], str(port)], stdout=DEVNULL, stderr=DEVNULL
        ) as flooding:
            done.wait(FLOOD_DURATION)
            flooding.kill()
        number += 1


def _text(report: Report, settled: float, duration: float) -> Iterator[str]:
    """Yield the lines of a report."""
    yield f"{report.blocks} blocks, {report.messages} messages, {len(report.faults)} faults"
    yield ", ".join(f"{word}: {sum(word in fault for fault in report.faults)}" for word in FAULT_WORDS)
    yield from report.faults[:60]
    yield from report.memory.lines(settled, duration)


if __name__ == "__main__":
    seconds = float(sys.argv[1])
    with open_server(*sys.argv[2:]) as opened:
        found = crowd(opened, seconds)
    print("\n".join(_text(found, min(WARM_UP_TIME, seconds / 4), seconds)))  # noqa: T201 - a program of its own
