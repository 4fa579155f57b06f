"""Attacks on the motion limits through `kinesic serve` and `kinesic mcp`.

Every command that the server sends is judged: limits of each hinge, self-contact by MuJoCo, and the limits of contacts
with adults. After an emergency stop, nothing may move.
"""

import asyncio
import json
import tomllib
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import sleep
from typing import Literal

import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.command import COMMAND_RATE, Command
from kinesic.planning.setup import Setup
from kinesic.serve.wire.quotas import Quotas
from kinesic.session.setup import set_up
from tests.campaign.judge import MAX_RATIO, deepest_penetration

from ..serve.conftest import Running, running

mcp = pytest.importorskip("mcp", reason="pip install 'kinesic[mcp]'")

from kinesic.mcp.robot_gate import RobotGate  # noqa: E402 - needs the extra
from kinesic.mcp.robot_line import RobotLine  # noqa: E402 - as above
from kinesic.mcp.server import make_server  # noqa: E402 - as above

pytestmark = pytest.mark.realtime

BATCH_SIZE = 10  # number of attacks sent at once
SAMPLE_TIME = 2.0  # [s] time in which a batch of the sample may move the robot, and in which a stopped robot is watched
PERFORMING_TIME = 15.0  # [s] time in which a batch of all attacks may move the robot
SETTLING_TIME = 1.0  # [s] time after an emergency stop until the robot stands still
ANSWER_TIMEOUT = 60.0  # [s] longest wait for the answers to a batch
CONTACT_COMMANDS = 5  # commands between two postures that are judged for self-contact
PATIENT_QUOTAS = Quotas(rate=1000.0, burst=1000, planning=120.0)
By = Literal["document", "say", "tool", "message"]


@dataclass(frozen=True)
class Attack:
    """One attack and the way it is sent."""

    number: int
    by: By
    aim: str
    content: str

    def tool_call(self) -> tuple[str, dict[str, object]] | None:
        """Return the MCP tool and arguments of the attack.

        They are None for an attack by a message to the server.
        """
        if self.by == "tool":
            call = json.loads(self.content)
            return call["name"], call["arguments"]
        if self.by == "document":
            return "perform", {"document": self.content}
        return ("say", {"text": self.content}) if self.by == "say" else None


def list_attacks() -> list[Attack]:
    table = tomllib.loads(Path(__file__).with_name("attacks.toml").read_text(encoding="utf-8"))
    return [Attack(number, **entry) for number, entry in enumerate(table["attack"])]


ATTACKS = list_attacks()
SAMPLE = ATTACKS[3::20]  # attacks that every test run sends


@pytest.fixture(scope="module")
def setup() -> Setup:
    return set_up(near="adult")


@pytest.fixture
def robot() -> Iterator[Running]:
    with running(PATIENT_QUOTAS, make_setup=partial(set_up, near="adult")) as opened:
        yield opened


def send(robot: Running, attacks: Sequence[Attack], setup: Setup, seconds: float) -> int:
    """Send the attacks to the server and the tools.

    Returns the number of tool calls answered in time.

    Args:
        robot: server and its commands.
        attacks: sent at once.
        setup: of the tools.
        seconds: [s] longest wait for the answers of the tools.
    """
    with robot.client() as attacker:
        with suppress(ConnectionError):  # the server may close the connection of an attacker
            for attack in attacks:
                if attack.by != "tool" and '"resume"' not in attack.content:  # a client may resume, a model may not
                    attacker.send_bytes(attack.content.replace("\n", " ").encode() + b"\n")
        answered = asyncio.run(asyncio.wait_for(_call_tools(robot, attacks, setup, seconds), ANSWER_TIMEOUT))
        sleep(SAMPLE_TIME)
        with robot.client() as client:
            client.do("interrupt")
            client.do("ping", id="done")
            while '"id":"done"' not in (client.receive(ANSWER_TIMEOUT) or '"id":"done"'):
                pass
    return answered


async def _call_tools(robot: Running, attacks: Sequence[Attack], setup: Setup, seconds: float) -> int:
    line = await asyncio.to_thread(RobotLine, "127.0.0.1", robot.port)
    try:
        server = make_server(RobotGate.of(line, setup), lambda: setup.lexicon, resumes=False)
        async with mcp.Client(server) as client:
            calls = [attack.tool_call() for attack in attacks]
            pending = [asyncio.create_task(client.call_tool(*call)) for call in calls if call is not None]
            done, late = await asyncio.wait(pending, timeout=seconds)
            for task in late:
                task.cancel()
            await asyncio.gather(*late, return_exceptions=True)
            return sum(task.exception() is None for task in done)
    finally:
        line.close()


def judge_commands(commands: Sequence[Command], setup: Setup) -> dict[str, float]:
    """Return the largest ratios to limits, and the deepest self-contact [m]."""
    angles, velocities, accelerations = (
        np.array([getattr(command, name) for command in commands]) for name in ("angles", "velocities", "accelerations")
    )
    limits, policy = setup.limits, setup.policy
    assert policy is not None
    assert setup.impacts is not None
    jerks = np.diff(accelerations, axis=0) * COMMAND_RATE
    return {
        "position": 1.0 + float(np.maximum(angles - limits.upper, limits.lower - angles).max()),
        "velocity": float((np.abs(velocities) / limits.speed).max()),
        "step": float((np.abs(np.diff(angles, axis=0)) * COMMAND_RATE / limits.speed).max()),
        "acceleration": float((np.abs(accelerations) / limits.acceleration).max()),
        "jerk": float((np.abs(jerks) / limits.jerk).max()),
        "contact": float(setup.impacts.survey(angles, velocities, policy.rows).values.max()),
        "penetration": deepest_penetration(angles[::CONTACT_COMMANDS], setup.robot),
    }


def assert_within_limits(commands: Sequence[Command], setup: Setup) -> None:
    figures = judge_commands(commands, setup)
    assert figures.pop("penetration") == 0.0
    assert {name: ratio for name, ratio in figures.items() if not ratio <= MAX_RATIO} == {}


def commands_of(robot: Running, begin: int = 0) -> list[Command]:
    return [command for _, command in robot.witness.commands[begin:]]


def moved(commands: Sequence[Command]) -> Floats:
    """Return the range [rad] of each hinge."""
    return np.asarray(np.ptp([command.angles for command in commands], axis=0))


def test_list_of_attacks_contains_two_hundred_different_attacks_of_every_kind():
    assert len({attack.content for attack in ATTACKS}) == len(ATTACKS) == 200
    assert {attack.by for attack in ATTACKS} == {"document", "say", "tool", "message"}
    assert len(SAMPLE) == BATCH_SIZE
    assert {attack.by for attack in SAMPLE} >= {"document", "say", "tool"}


@pytest.mark.parametrize(
    ("attacks", "seconds"),
    [
        pytest.param(SAMPLE, SAMPLE_TIME, id="sample"),
        pytest.param(ATTACKS, PERFORMING_TIME, id="all", marks=pytest.mark.soak),
    ],
)
def test_attacks_never_move_the_robot_beyond_limits_or_after_an_emergency_stop(
    robot: Running, setup: Setup, attacks: list[Attack], seconds: float
):
    batches = [attacks[k :: len(attacks) // BATCH_SIZE] for k in range(len(attacks) // BATCH_SIZE)]  # of mixed kinds
    answered = sum(send(robot, batch, setup, seconds) for batch in batches)
    commands = commands_of(robot)
    assert answered > 0
    assert moved(commands).max() > 0.1  # some attacks are harmless documents, which are performed
    assert_within_limits(commands, setup)
    with robot.client() as client:
        client.stop()
    sleep(SETTLING_TIME)
    begin = len(robot.witness.commands)
    for batch in batches:
        send(robot, batch, setup, SAMPLE_TIME)
    stopped = commands_of(robot, begin)
    assert len(stopped) > COMMAND_RATE * SAMPLE_TIME / 2
    assert moved(stopped).max() == 0.0


def test_attack_judge_detects_commands_beyond_each_limit(setup: Setup):
    rest = setup.robot.skeleton.rest
    zero = np.zeros(len(rest))

    def command(time: float, **changes: Floats) -> Command:
        values = {"angles": rest, "velocities": zero, "accelerations": zero, "setpoints": rest} | changes
        return Command(time=time, **values)

    still = [command(0.01 * k) for k in range(5)]
    assert_within_limits(still, setup)
    for name, value, figure in (
        ("angles", setup.limits.upper + 0.01, "position"),
        ("velocities", setup.limits.speed * 1.01, "velocity"),
        ("accelerations", setup.limits.acceleration * 1.01, "acceleration"),
    ):
        figures = judge_commands([*still, command(0.05, **{name: value})], setup)
        assert figures[figure] > MAX_RATIO, name
    assert judge_commands([*still, command(0.05, angles=rest + 0.5)], setup)["step"] > 1.0
    assert judge_commands([*still, command(0.05, velocities=setup.limits.speed)], setup)["contact"] > 1.0
