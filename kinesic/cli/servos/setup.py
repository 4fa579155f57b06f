"""Verbs `kinesic servos set-id`, `set-baud` and `reboot`: settings of one servo."""

from pathlib import Path

import click

from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.tools.servo_setup import reboot, set_baud, set_id


def change_id(port: Path, servo: int, new: int, baud: int) -> int:
    """Change the id of one servo, and verify it."""
    wire = SerialWire(port, baud)
    try:
        reply = set_id(wire, servo, new)
    finally:
        wire.close()
    click.echo(f"{reply.name}: id {servo} -> {reply.id}")
    return 0


def change_baud(port: Path, servo: int, new: int, baud: int) -> int:
    """Change the baud rate of one servo, and verify it."""
    reply = set_baud(lambda rate: SerialWire(port, rate), servo, baud=baud, new=new)
    click.echo(f"{reply.name}, id {reply.id}: {baud} -> {new} baud")
    return 0


def restart_servo(port: Path, servo: int, baud: int) -> int:
    """Restart one servo, and verify that it answers."""
    wire = SerialWire(port, baud)
    try:
        reply = reboot(wire, servo)
    finally:
        wire.close()
    click.echo(f"{reply.name}, id {reply.id}: restarted, torque is off")
    return 0
