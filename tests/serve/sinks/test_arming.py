"""Torque for servos: only where the token, a confirmation in time and a robot at rest come together."""

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

TOKEN, NOD = "open sesame", '<bml id="{}"><head id="n" lexeme="NOD" start="0"/></bml>'
pytestmark = pytest.mark.realtime


class Limp:
    """Two servos that keep what they are told."""

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
    """A client that has shown the token."""

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
    with running(Quotas(), Access(TOKEN), more=[limp]) as found:
        yield found


@pytest.fixture
def guest(armable: Running, limp: Limp) -> Iterator[Guest]:
    limp.armed, limp.state, limp.fails = False, "limp", ""
    with connect(f"ws://localhost:{armable.port}/") as socket:
        asking, end = Guest(armable, socket), monotonic() + 20.0
        while asking.ask(do="status")["state"] != "resting":  # as it does not yet when the server has just begun
            assert monotonic() < end, "the motion goes on"
            sleep(0.02)
        yield asking


def test_servos_follow_after_a_confirmation_and_rest_without_torque_until_the_next(guest: Guest, limp: Limp):
    limp.commands.clear()
    asked = guest.ask(do="arm", token=TOKEN, id=7)
    assert (asked["told"], asked["id"], asked["servos"]) == ("confirm", 7, 2)
    assert not limp.armed
    assert guest.ask(do="arm", token=TOKEN, code=asked["code"], id=8) == {"told": "armed", "id": 8}
    end = monotonic() + 5.0
    while not limp.commands:
        assert monotonic() < end, "no command comes"
        sleep(0.01)
    assert guest.ask(do="arm", token=TOKEN)["why"] == "the servos have their torque already"
    guest.socket.send(json.dumps({"do": "disarm", "id": 9}))
    while "disarmed" not in (told := guest.socket.recv(20)):
        pass
    assert json.loads(told)["id"] == 9
    assert not limp.armed


@pytest.mark.parametrize("token", [None, "open barley", ""])
def test_without_the_token_in_the_message_nobody_arms(guest: Guest, limp: Limp, token: str | None):
    code = guest.ask(do="arm", token=TOKEN)["code"]
    assert "token" in guest.ask(do="arm", token=token, code=code)["why"]
    assert "token" in guest.ask(do="arm", token=token)["why"]
    assert guest.ask(do="arm", token=TOKEN, code=code)["told"] == "refused", "the code is void"
    assert not limp.armed


@pytest.mark.parametrize("code", ["", "0" * 16, "ä"])
def test_without_a_confirmation_nobody_arms(guest: Guest, limp: Limp, code: str):
    assert "not confirmed" in guest.ask(do="arm", token=TOKEN, code=code)["why"]
    right = guest.ask(do="arm", token=TOKEN)["code"]
    assert "not confirmed" in guest.ask(do="arm", token=TOKEN, code=code)["why"]
    assert guest.ask(do="arm", token=TOKEN, code=right)["told"] == "refused", "one guess is all"
    assert not limp.armed


def test_a_confirmation_is_the_client_s_own_counts_once_and_lapses(
    guest: Guest, limp: Limp, monkeypatch: pytest.MonkeyPatch
):
    with connect(f"ws://localhost:{guest.server.port}/") as socket:
        other = Guest(guest.server, socket)
        code = guest.ask(do="arm", token=TOKEN)["code"]
        assert other.ask(do="arm", token=TOKEN, code=code)["told"] == "refused"
    monkeypatch.setattr(arming, "LASTS", 0.0)
    assert guest.confirm()["told"] == "refused"
    monkeypatch.undo()
    code = guest.ask(do="arm", token=TOKEN)["code"]
    assert guest.ask(do="arm", token=TOKEN, code=code)["told"] == "armed"
    guest.ask(do="disarm")
    assert guest.ask(do="arm", token=TOKEN, code=code)["told"] == "refused"


def test_strangers_and_foreign_pages_do_not_come_so_far(armable: Running, limp: Limp):
    with connect(f"ws://localhost:{armable.port}/") as socket:
        socket.send('{"do": "arm"}')
        assert json.loads(socket.recv(5))["told"] == "refused"
    with pytest.raises(InvalidStatus):
        connect(f"ws://localhost:{armable.port}/", origin="http://evil.example").close()
    assert not limp.armed


def test_nothing_is_performed_without_torque_and_nobody_arms_a_robot_that_is_stopped(guest: Guest, limp: Limp):
    guest.socket.send(NOD.format("limp"))
    assert "arm them first" in guest.socket.recv(10)
    assert guest.ask(do="stop")["told"] == "stopped"
    assert "resume first" in guest.ask(do="arm", token=TOKEN)["why"]
    guest.socket.send('{"do": "resume"}')
    end = monotonic() + 20.0
    assert guest.ask(do="status")["servos"] == "limp"
    while not limp.armed:  # it moves on before it rests, and begins to some time after it was asked to
        asked = guest.ask(do="arm", token=TOKEN)
        if asked["told"] == "confirm":
            asked = guest.ask(do="arm", token=TOKEN, code=asked["code"])
        assert asked["told"] == "armed" or "the motion goes on" in asked["why"]
        assert monotonic() < end
        sleep(0.05)
    guest.ask(do="disarm")


def test_servos_whose_supervisor_has_ended_are_opened_anew_and_a_failure_is_told(guest: Guest, limp: Limp):
    limp.state, before = "ended", limp.revived
    assert guest.confirm()["told"] == "armed"
    assert limp.revived == before + 1
    limp.fails = "the robot cannot fold"
    assert guest.ask(do="disarm") == {"told": "refused", "id": 0, "why": "the robot cannot fold"}


def test_every_servo_is_told_by_name_and_by_figures(guest: Guest):
    told = guest.ask(do="servos", id=3)
    assert told["servos"][0] == {"bus": "body", "id": 1, "hinge": "hinge1", "model": "xm430_w210", "hottest": 80}
    body = guest.ask(do="watch", rate=50.0)
    guest.socket.send('{"do": "watch", "rate": 0}')
    assert body["servos"]["celsius"] == [40.0, None]
    assert body["servos"]["state"] == "limp"
    assert body["angles"] == [0.25] * 22, "they are measured without torque, too"


def test_a_server_without_servos_says_so(server: Running):
    with connect(f"ws://localhost:{server.port}/") as socket:
        for do in ("arm", "disarm"):
            socket.send(json.dumps({"do": do}))
            assert "--on servos" in json.loads(socket.recv(5))["why"]
