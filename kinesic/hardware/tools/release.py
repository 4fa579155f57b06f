"""Release of all servos: torque is switched off and verified.

Joints that would fall are reported before. A silent servo does not delay the others.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from math import nan

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.hardware.protocol.device import ServoAccess
from kinesic.hardware.protocol.frame_access import open_access
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.tables import FamilyTable
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.tools.survey import open_slow_access

RELEASE_REPEATS = 2  # Number of torque-off broadcasts before each servo is verified


def holding_angles(manifest: Manifest, wires: Mapping[str, Wire]) -> Floats:
    """Read joint angles (n,) [rad], the rest angle for joints without torque.

    NaN if a servo is silent.

    Args:
        manifest: servos of the robot.
        wires: open wires, by bus name; servos on other buses count as silent.
    """
    angles, accesses = manifest.rest.copy(), dict[str, ServoAccess]()
    for name, wire in wires.items():
        with suppress(BusError):
            accesses[name] = open_slow_access(wire, manifest.tables[name])
    for k, member in enumerate(manifest.members):
        rest, angle = manifest.rest[member.joint], nan
        with suppress(BusError, KeyError):
            ticks = np.full(len(manifest.members), accesses[member.bus].read(member.id, Register.PRESENT_POSITION))
            held = accesses[member.bus].read(member.id, Register.TORQUE_ENABLE)
            angle = float(manifest.scale.angles(ticks)[k]) if held else rest
        if not abs(angle - rest) <= abs(
            angles[member.joint] - rest
        ):  # of several servos the farthest or a silent one counts
            angles[member.joint] = angle
    return angles


def release_servos(
    wires: Mapping[str, Wire], servos: Mapping[str, Sequence[int]], tables: Mapping[str, FamilyTable | None]
) -> tuple[str, ...]:
    """Switch torque off on all servos, and verify it.

    Args:
        wires: open wires, by name.
        servos: ids that must be without torque then, by wire name; other answering servos must be, too.
        tables: control table of the family on each wire; None: X series with Protocol 2.0.

    Returns:
        One line per servo that may still have torque.
    """
    accesses: dict[str, ServoAccess] = {}
    lines: list[str] = []
    for name, wire in wires.items():  # all wires first, so that no servo waits for the replies of another wire
        try:
            for _ in range(RELEASE_REPEATS):
                open_access(wire, tables.get(name)).release_all()
            accesses[name] = open_slow_access(wire, tables.get(name))
        except BusError as error:
            lines.append(f"{error}; its servos may still have torque: switch the power off")
    for name, access in accesses.items():
        lines += _doubts(access, servos.get(name, ()))
    return tuple(lines)


def _doubts(access: ServoAccess, servos: Sequence[int]) -> list[str]:
    try:
        others = [servo.id for servo in access.ping_all() if servo.id not in servos]
        return [line for servo in (*servos, *others) if (line := _doubt(access, servo))]
    except BusError as error:
        return [f"{error}; its servos may still have torque: switch the power off"]


def _doubt(access: ServoAccess, servo: int) -> str:
    where = f"{access.wire.name}: servo {servo}"
    try:
        if access.read(servo, Register.TORQUE_ENABLE):
            access.write(servo, Register.TORQUE_ENABLE, 0)
        limp = not access.read(servo, Register.TORQUE_ENABLE)
    except BusError:
        return f"{where}: does not answer, and may still have torque; switch the power off"
    return "" if limp else f"{where}: keeps its torque; switch the power off"
