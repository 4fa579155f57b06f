"""Changes of id and baud rate, and restart, of a single servo."""

from collections.abc import Callable
from dataclasses import dataclass

from kinesic.hardware.protocol.device import PingReply, ServoAccess
from kinesic.hardware.protocol.frame_access import FrameAccess
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError, Wire

REBOOT_TIME = 0.5  # [s] time until a restarted servo answers


@dataclass(frozen=True)
class IdentifiedServo:
    """Servo that answers, with access in its own protocol."""

    access: ServoAccess
    reply: PingReply


def identify_servo(wire: Wire, servo: int) -> IdentifiedServo:
    """Find out which protocol a servo speaks, and return access to it.

    Raises:
        BusError: no servo of a known model answers with this id.
    """
    for access in (ServoAccess(wire, tries=2), FrameAccess(wire, tries=2)):
        reply = access.ping(servo)
        if reply is not None and reply.model is not None:
            if access.is_shared(servo):
                raise BusError(f"{wire.name}: several servos have id {servo}; connect one at a time")
            return IdentifiedServo(access, reply)
    raise BusError(f"{wire.name}: no known servo answers as id {servo} at {wire.baud} baud; run `kinesic servos scan`")


def set_id(wire: Wire, servo: int, new: int) -> PingReply:
    """Change the id of a servo and verify it with a ping.

    Returns the servo's reply under the new id.

    Raises:
        BusError: the new id is taken, the servo has torque, or does not take the id.
    """
    found = identify_servo(wire, servo)
    access = found.access
    if new != servo and access.ping(new) is not None:
        raise BusError(f"{wire.name}: id {new} is taken; connect one servo at a time")
    _require_torque_off(found)
    if new != servo:
        access.write(servo, Register.ID, new)
    reply = access.ping(new)
    if reply is None or reply.number != found.reply.number:
        raise BusError(f"{wire.name}: servo {servo} does not answer as id {new}; run `kinesic servos scan`")
    return reply


def set_baud(opened: Callable[[int], Wire], servo: int, *, baud: int, new: int) -> PingReply:
    """Change the baud rate of a servo and verify it.

    Returns the servo's reply at the new rate.

    Args:
        opened: opens the port at a baud rate.
        servo: id.
        baud: [bit/s] present rate.
        new: [bit/s] new rate.

    Raises:
        BusError: its model lacks the rate, the servo has torque, or does not answer at the new rate.
    """
    wire = opened(baud)
    try:
        found = identify_servo(wire, servo)
        _require_torque_off(found)
        code = _rate_code(found, new)
        try:
            found.access.write(servo, Register.BAUD_RATE, code)
        except BusError:  # the servo may answer at the new rate already
            if found.access.ping(servo) is not None:
                raise
    finally:
        wire.close()
    wire = opened(new)
    try:
        return identify_servo(wire, servo).reply
    finally:
        wire.close()


def reboot(wire: Wire, servo: int) -> PingReply:
    """Restart a servo, which clears its errors and switches torque off.

    Raises:
        BusError: the servo has torque, cannot restart, or does not answer afterwards.
    """
    found = identify_servo(wire, servo)
    _require_torque_off(found)
    found.access.reboot(servo)
    wire.sleep(wire.now() + REBOOT_TIME)
    reply = found.access.ping(servo)
    if reply is None:
        raise BusError(f"{wire.name}: servo {servo} does not answer after its restart")
    return reply


def _rate_code(found: IdentifiedServo, baud: int) -> int:
    model = found.reply.model
    try:
        return -1 if model is None else model.baud_code(baud)
    except ValueError as error:
        raise BusError(f"{found.access.wire.name}: servo {found.reply.id}: {error}") from None


def _require_torque_off(found: IdentifiedServo) -> None:
    """Refuse a servo with torque, whose limb would fall.

    Raises:
        BusError: torque is on.
    """
    if found.access.read(found.reply.id, Register.TORQUE_ENABLE):
        where = f"{found.access.wire.name}: servo {found.reply.id}"
        raise BusError(f"{where} has torque; hold the robot, then use `kinesic servos release`")
