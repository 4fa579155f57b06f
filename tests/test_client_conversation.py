"""Methods of the client for conversations: messages as the server reads them."""

import pytest

from kinesic.client import Client
from kinesic.serve.wire.conversing import (
    ConverseRequest,
    HeardReport,
    PeopleReport,
    SeenPerson,
    ThinkRequest,
    TurnReport,
)
from kinesic.serve.wire.protocol import DuckRequest, InterruptCommand, read_control


class Recorder(Client):
    """Client that records its messages instead of sending them."""

    def __init__(self) -> None:
        self.sent: list[bytes] = []

    def send(self, bml: str) -> None:
        self.sent.append(bml.encode())


@pytest.fixture
def robot() -> Recorder:
    return Recorder()


def test_conversation_methods_of_the_client_send_valid_messages_with_all_their_values(robot: Recorder) -> None:
    robot.converse(amount=0.5, fillers=True)
    robot.people({"a": (1.0, 0.5, 1.5), "b": (2.0, 0.0, 1.0)}, looking=("b",), age=0.1)
    robot.heard(voice=True, who="a", age=0.2)
    robot.heard(text="so I", final=True)
    robot.turn(0.8)
    robot.think(on=False)
    robot.duck()
    robot.interrupt("x", yield_=True)
    robot.interrupt()
    people = (SeenPerson("a", (1.0, 0.5, 1.5)), SeenPerson("b", (2.0, 0.0, 1.0), looks=True))
    assert [read_control(message) for message in robot.sent] == [
        ConverseRequest(amount=0.5, fillers=True),
        PeopleReport(people, age=0.1),
        HeardReport(voice=True, who="a", age=0.2),
        HeardReport(text="so I", final=True),
        TurnReport(0.8),
        ThinkRequest(on=False),
        DuckRequest(on=True),
        InterruptCommand("x", yields=True),
        InterruptCommand(),
    ]


def test_conversation_methods_of_the_client_send_begin_by_default_and_end_on_request(robot: Recorder) -> None:
    robot.converse()
    robot.converse(on=False)
    robot.think()
    robot.duck(on=False)
    assert [read_control(message) for message in robot.sent] == [
        ConverseRequest(),
        ConverseRequest(on=False),
        ThinkRequest(),
        DuckRequest(on=False),
    ]
