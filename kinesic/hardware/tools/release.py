"""Takes the torque of every servo and checks that it is gone; says before what will fall.

No servo is left out because of another.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from math import nan

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.device import Cold
from kinesic.hardware.protocol.packet import BROADCAST
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.tools.survey import open_slow_access

TIMES = 2  # that all are told, before each is asked
OFF = packet.write_packet(BROADCAST, Register.TORQUE_ENABLE.field.address, b"\0")


def held_angles(manifest: Manifest, wires: Mapping[str, Wire]) -> Floats:
    """Reads (n,) [rad] where joints are held by torque; limp ones count as at rest; NaN: a servo is silent.

    Args:
        manifest: of the servos.
        wires: open ones, by the name of the bus; servos on others count as silent.
    """
    angles, colds = manifest.rest.copy(), dict[str, Cold]()
    for name, wire in wires.items():
        with suppress(BusError):
            colds[name] = open_slow_access(wire)
    for k, member in enumerate(manifest.members):
        rest, angle = manifest.rest[member.joint], nan
        with suppress(BusError, KeyError):
            ticks = np.full(len(manifest.members), colds[member.bus].read(member.id, Register.PRESENT_POSITION))
            held = colds[member.bus].read(member.id, Register.TORQUE_ENABLE)
            angle = float(manifest.scale.angles(ticks)[k]) if held else rest
        if not abs(angle - rest) <= abs(angles[member.joint] - rest):  # of several servos, who is farthest, or silent
            angles[member.joint] = angle
    return angles


def release_servos(wires: Mapping[str, Wire], servos: Mapping[str, Sequence[int]]) -> tuple[str, ...]:
    """Takes the torque of all servos.

    Args:
        wires: open ones, by name.
        servos: ids that must be limp then, by the name of the wire; whoever else answers must be, too.

    Returns:
        A line for each servo of which that is not sure; empty if all are limp.
    """
    colds: dict[str, Cold] = {}
    lines: list[str] = []
    for name, wire in wires.items():  # all wires first: a servo must not wait for another wire's answers
        try:
            for _ in range(TIMES):
                wire.write(OFF)
            colds[name] = open_slow_access(wire)
        except BusError as error:
            lines.append(f"{error}; its servos may still have torque: switch the power off")
    for name, cold in colds.items():
        lines += _doubts(cold, servos.get(name, ()))
    return tuple(lines)


def _doubts(cold: Cold, servos: Sequence[int]) -> list[str]:
    try:
        others = [servo.id for servo in cold.everyone() if servo.id not in servos]
        return [line for servo in (*servos, *others) if (line := _doubt(cold, servo))]
    except BusError as error:
        return [f"{error}; its servos may still have torque: switch the power off"]


def _doubt(cold: Cold, servo: int) -> str:
    where = f"{cold.wire.name}: servo {servo}"
    try:
        if cold.read(servo, Register.TORQUE_ENABLE):
            cold.write(servo, Register.TORQUE_ENABLE, 0)
        limp = not cold.read(servo, Register.TORQUE_ENABLE)
    except BusError:
        return f"{where}: does not answer, and may still have torque; switch the power off"
    return "" if limp else f"{where}: keeps its torque; switch the power off"
