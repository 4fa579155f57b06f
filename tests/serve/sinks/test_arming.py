"""Arming over the wire: needs token, timely confirmation and a resting robot."""

import json
from collections.abc import Iterator
from time import monotonic, sleep

import numpy as np
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

from kinesic.body.command import Command
from kinesic.hardware.protocol.wire import BusError
from kinesic.serve.messages import ServoHealth, ServoPlace, ServoReport, ServoState
from kinesic.serve.sinks import arming
from kinesic.serve.wire.origin import Access
from kinesic.serve.wire.quotas import Quotas

from ..conftest import Running, running

TOKEN = "open sesame"
NOD = '<bml id="{}"><head id="n" lexeme="NOD" start="0"/></bml>'
pytestmark = pytest.mark.realtime


class Limp:
    """Two stub servos that record their calls."""

    def __init__(self) -> None:
        self.armed, self.state, self.revived, self.fails = False, "limp", 0, ""
        self.commands: list[Command] = []
        self.members = tuple(ServoPlace("body", k, f"hinge{k}", "xm430_w210", 80) for k in (1, 2))

    state: ServoState

    def write(self, command: Command, /) -> None:
        if self.armed:
            self.commands.append(command)

    def health(self) -> ServoHealth:
        figures = ((40.0, np.nan), (0.5, np.nan), (11.9, np.nan), (0.0, np.nan), (float(self.armed), np.nan))
        return ServoHealth(np.full(22, 0.25), 40.0, 11.9, False, ServoReport(self.state, *figures))

    def arm(self) -> None:
        self.armed, self.state = True, "armed"

    def disarm(self) -> None:
        if self.fails:
            raise BusError(self.fails)
        self.armed, self.state = False, "limp"

    def revive(self) -> None:
        self.revived += 1
        self.state = "limp"

    def close(self) -> None:
        pass


class Guest:
    """Client that has sent the token."""

    def __init__(self, server: Running, socket: ClientConnection) -> None:
        self.server, self.socket = server, socket
        assert self.ask(do="hello", token=TOKEN)["told"] == "welcome"

    def ask(self, **message: object) -> dict:
        self.socket.send(json.dumps(message))
        return json.loads(self.socket.recv(20))

    def confirm(self, **more: object) -> dict:
        asked = self.ask(do="arm", token=TOKEN)
        assert "code" in asked, asked
        return self.ask(do="arm", token=TOKEN, code=asked["code"], **more)


@pytest.fixture(scope="module")
def limp() -> Limp:
    return Limp()


@pytest.fixture(scope="module")
def armable(limp: Limp) -> Iterator[Running]:
    with running(Quotas(), Access(TOKEN), more=[limp]) as result:
        yield result


@pytest.fixture
def guest(armable: Running, limp: Limp) -> Iterator[Guest]:
    limp.armed, limp.state, limp.fails = False, "limp", ""
    with connect(f"ws://localhost:{armable.port}/") as socket:
        asking, end = Guest(armable, socket), monotonic() + 20.0
        while asking.ask(do="status")["state"] != "resting":  # not true directly after the server start
            assert monotonic() < end, "the motion continues"
            sleep(0.02)
        yield asking


def test_servos_get_commands_from_the_arming_confirmation_until_they_are_disarmed(guest: Guest, limp: Limp):
    limp.commands.clear()
    asked = guest.ask(do="arm", token=TOKEN, id=7)
    assert (asked["told"], asked["id"], asked["servos"]) == ("confirm", 7, 2)
    assert not limp.armed
    assert guest.ask(do="arm", token=TOKEN, code=asked["code"], id=8) == {"told": "armed", "id": 8}
    end = monotonic() + 5.0
    while not limp.commands:
        assert monotonic() < end, "no command comes"
        sleep(0.01)
    assert guest.ask(do="arm", token=TOKEN)["why"] == "the servos are armed already"
    guest.socket.send(json.dumps({"do": "disarm", "id": 9}))
    while "disarmed" not in (message := guest.socket.recv(20)):
        pass
    assert json.loads(message)["id"] == 9
    assert not limp.armed


@pytest.mark.parametrize("token", [None, "open barley", ""])
def test_request_to_arm_servos_needs_the_token_in_its_message(guest: Guest, limp: Limp, token: str | None):
    code = guest.ask(do="arm", token=TOKEN)["code"]
    assert "token" in guest.ask(do="arm", token=token, code=code)["why"]
    assert "token" in guest.ask(do="arm", token=token)["why"]
    assert guest.ask(do="arm", token=TOKEN, code=code)["told"] == "refused", "the code is void"
    assert not limp.armed


@pytest.mark.parametrize("code", ["", "0" * 16, "ä"])
def test_wrong_confirmation_code_for_arming_is_refused_and_invalidates_the_right_code(
    guest: Guest, limp: Limp, code: str
):
    assert "not confirmed" in guest.ask(do="arm", token=TOKEN, code=code)["why"]
    right = guest.ask(do="arm", token=TOKEN)["code"]
    assert "not confirmed" in guest.ask(do="arm", token=TOKEN, code=code)["why"]
    assert guest.ask(do="arm", token=TOKEN, code=right)["told"] == "refused", "one guess is all"
    assert not limp.armed


def test_confirmation_code_for_arming_is_valid_once_for_its_client_and_expires(
    guest: Guest, limp: Limp, monkeypatch: pytest.MonkeyPatch
):
    with connect(f"ws://localhost:{guest.server.port}/") as socket:
        other = Guest(guest.server, socket)
        code = guest.ask(do="arm", token=TOKEN)["code"]
        assert other.ask(do="arm", token=TOKEN, code=code)["told"] == "refused"
    monkeypatch.setattr(arming, "CONFIRMATION_TIMEOUT", 0.0)
    assert guest.confirm()["told"] == "refused"
    monkeypatch.undo()
    code = guest.ask(do="arm", token=TOKEN)["code"]
    assert guest.ask(do="arm", token=TOKEN, code=code)["told"] == "armed"
    guest.ask(do="disarm")
    assert guest.ask(do="arm", token=TOKEN, code=code)["told"] == "refused"


def test_unauthenticated_clients_and_foreign_web_pages_cannot_arm_servos(armable: Running, limp: Limp):
    with connect(f"ws://localhost:{armable.port}/") as socket:
        socket.send('{"do": "arm"}')
        assert json.loads(socket.recv(5))["told"] == "refused"
    with pytest.raises(InvalidStatus):
        connect(f"ws://localhost:{armable.port}/", origin="http://evil.example").close()
    assert not limp.armed


def test_documents_are_refused_without_torque_and_arming_is_refused_until_a_stop_is_resumed(guest: Guest, limp: Limp):
    guest.socket.send(NOD.format("limp"))
    assert "arm them first" in guest.socket.recv(10)
    assert guest.ask(do="stop")["told"] == "stopped"
    assert "resume first" in guest.ask(do="arm", token=TOKEN)["why"]
    guest.socket.send('{"do": "resume"}')
    end = monotonic() + 20.0
    assert guest.ask(do="status")["servos"] == "limp"
    while not limp.armed:  # it continues for a while and decelerates some time after the request
        asked = guest.ask(do="arm", token=TOKEN)
        if asked["told"] == "confirm":
            asked = guest.ask(do="arm", token=TOKEN, code=asked["code"])
        assert asked["told"] == "armed" or "the robot moves" in asked["why"]
        assert monotonic() < end
        sleep(0.05)
    guest.ask(do="disarm")


def test_arming_reopens_servos_of_an_ended_supervisor_and_a_disarming_failure_is_reported(guest: Guest, limp: Limp):
    limp.state, before = "ended", limp.revived
    assert guest.confirm()["told"] == "armed"
    assert limp.revived == before + 1
    limp.fails = "the robot cannot fold"
    assert guest.ask(do="disarm") == {"told": "refused", "id": 0, "why": "the robot cannot fold"}


def test_each_servo_is_reported_with_identity_and_telemetry(guest: Guest):
    answer = guest.ask(do="servos", id=3)
    assert answer["servos"][0] == {"bus": "body", "id": 1, "hinge": "hinge1", "model": "xm430_w210", "hottest": 80}
    body = guest.ask(do="watch", rate=50.0)
    guest.socket.send('{"do": "watch", "rate": 0}')
    assert body["servos"]["celsius"] == [40.0, None]
    assert body["servos"]["state"] == "limp"
    assert body["angles"] == [0.25] * 22, "they are measured without torque, too"


def test_arming_without_servos_is_refused(server: Running):
    with connect(f"ws://localhost:{server.port}/") as socket:
        for do in ("arm", "disarm"):
            socket.send(json.dumps({"do": do}))
            assert "--on servos" in json.loads(socket.recv(5))["why"]
