"""Virtual servos answer like a reference model of the manual.

The manual does not specify these cases, which are excluded: the servo that answers after a silent one in a plain sync
read (none in the reference, the next one in kinesic), an instruction with a wrong number of parameters (refused here),
a wrong value in REG_WRITE (refused here at ACTION), the error of a write with several errors, the duration of a start,
and a wrong CRC (no answer in kinesic, an error in the reference).
"""

from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

from ...examples import examples
from ...hardware.manual.adapter import ManualWire, build_manual
from ...manual_servo import packet as p
from ...manual_servo.table import MODELS, items

SERVO_IDS = (1, 2)
MAX_START_TIME = 0.4  # [s] longest start of a servo
RESTART_INSTRUCTIONS = (p.REBOOT, p.FACTORY_RESET, p.BACKUP)  # instructions after which a servo restarts
SENSED_ADDRESSES = range(120, 148)  # register addresses of measured values
FAST_READS = (p.FAST_SYNC_READ, p.FAST_BULK_READ)  # instructions with one combined answer
TESTED_MODELS = ("xm430_w210", "xm540_w150", "xc430_w240", "xc330_t288")
WRITTEN_REGISTERS = {
    (i.address, i.size) for m in TESTED_MODELS for n, i in items(MODELS[m], 1, 52).items() if n not in ("id", "baud")
}
# (address, size [bytes]) of indirect addresses and indirect data
INDIRECT_CELLS = {(a, 2) for a in (168, 170, 172, 578)} | {(a, 1) for a in (208, 209, 224, 225, 634)}
WRITE_PLACES = st.sampled_from(sorted(p for p in WRITTEN_REGISTERS | INDIRECT_CELLS if p[0] not in SENSED_ADDRESSES))
EDGE_VALUES = (  # register values at or near limits
    0,
    1,
    2,
    3,
    4,
    5,
    8,
    16,
    64,
    65,
    98,
    100,
    116,
    117,
    127,
    224,
    253,
    255,
    885,
    886,
    1024,
    2000,
    3000,
    4095,
    4096,
)
WRITE_VALUES = st.sampled_from([*EDGE_VALUES, -1, -100, 16_383, 16_384, 32_767, 1_048_576]) | st.integers(
    -(2**31), 2**32 - 1
)
TARGET_IDS = st.sampled_from([1, 1, 2, 5, p.BROADCAST_ID])


def words(*values: int) -> bytes:
    return b"".join(value.to_bytes(2, "little") for value in values)


@st.composite
def writes(draw: st.DrawFn) -> tuple[int, bytes]:
    """Draw an address and the bytes of up to two registers."""
    address, size = draw(WRITE_PLACES)
    size = max(1, size + draw(st.sampled_from([0, 0, 0, 0, 1, -1])))
    return address, (draw(WRITE_VALUES) % 256**size).to_bytes(size, "little")


@st.composite
def instructions(draw: st.DrawFn) -> bytes:
    """Draw a well-formed instruction."""
    kind = draw(st.sampled_from(["write"] * 4 + ["read"] * 3 + ["register", "action", "sync", "bulk", "group", "rest"]))
    whom, (address, data) = draw(TARGET_IDS), draw(writes())
    if kind == "write":
        return p.instruct(whom, p.WRITE, words(address) + data)
    if kind == "read":
        start, size = draw(WRITE_PLACES)
        return p.instruct(whom, p.READ, words(start, size))
    if kind == "register":
        return p.instruct(whom, p.REG_WRITE, words(65) + bytes([draw(st.integers(0, 1))]))
    if kind == "action":
        return p.instruct(whom, p.ACTION)
    if kind == "sync":
        both = b"".join(bytes([servo]) + data for servo in SERVO_IDS)
        return p.instruct(p.BROADCAST_ID, p.SYNC_WRITE, words(address, len(data)) + both)
    if kind == "bulk":
        return p.instruct(
            p.BROADCAST_ID, p.BULK_WRITE, b"\1" + words(address, len(data)) + data + b"\2" + words(65, 1) + b"\1"
        )
    if kind == "group":
        start, size = draw(WRITE_PLACES)
        order = bytes(draw(st.permutations(SERVO_IDS)))
        if draw(st.booleans()):
            return p.instruct(
                p.BROADCAST_ID, draw(st.sampled_from([p.SYNC_READ, p.FAST_SYNC_READ])), words(start, size) + order
            )
        asked = b"".join(bytes([servo]) + words(start, size) for servo in order)
        return p.instruct(p.BROADCAST_ID, draw(st.sampled_from([p.BULK_READ, p.FAST_BULK_READ])), asked)
    rest = [(p.PING, b""), (p.REBOOT, b""), (p.FACTORY_RESET, b"\2"), (p.CLEAR, bytes.fromhex("0144584C22"))]
    return p.instruct(whom, *draw(st.sampled_from([*rest, (0x77, b"")])))


@dataclass(frozen=True)
class StatusReply:
    """One status packet."""

    servo: int
    error: int
    data: bytes

    def agrees(self, other: "StatusReply", *, exact: bool) -> bool:
        """Return whether two answers agree in all specified fields."""
        alike = self.error == other.error or (not exact and bool(self.error) and bool(other.error))
        return alike and (self.servo, self.data) == (other.servo, other.data)


class Host:
    """Servos of one implementation, and the port to these servos."""

    def __init__(self, wire: MemoryWire | ManualWire) -> None:
        self.wire, self._decoder = wire, p.Decoder()

    def ask(self, data: bytes) -> list[StatusReply]:
        """Send an instruction and return the answers."""
        self.wire.write(data)
        end, raw = self.wire.now() + 0.02, b""
        while came := self.wire.read(end):
            raw += came
        if data[7] in RESTART_INSTRUCTIONS:
            self.wire.sleep(self.wire.now() + MAX_START_TIME)
        if data[7] in FAST_READS:
            return [StatusReply(p.BROADCAST_ID, 0, raw)]
        result = self._decoder.feed(raw, self.wire.now())
        return [StatusReply(s.servo, s.parameters[0], s.parameters[1:]) for s in result]


def whole(data: bytes) -> bool:
    """Return whether a write covers at most one complete register."""
    return data[7] != p.WRITE or (int.from_bytes(data[8:10], "little"), len(data) - 12) in WRITTEN_REGISTERS


def compare(own: Host, manual: Host, data: bytes) -> None:
    """Send an instruction to both implementations and compare the answers."""
    answer, expected = own.ask(data), manual.ask(data)
    assert len(answer) == len(expected), data.hex()
    for one, other in zip(answer, expected, strict=True):
        assert one.agrees(other, exact=whole(data)), (data.hex(), one, other)


@examples(80)
@given(st.sampled_from(TESTED_MODELS), st.lists(instructions(), max_size=25))
def test_virtual_servos_answer_random_instructions_like_a_model_written_from_the_servo_manual(
    model: str, stream: list[bytes]
):
    cable = Cable("body", tuple(ServoFitting(servo, model=model) for servo in SERVO_IDS))
    own = Host(MemoryWire(build_bus([cable])[1]["body"]))
    manual = Host(ManualWire(build_manual([cable])[1]["body"]))
    for data in stream:
        compare(own, manual, data)
    for item in items(MODELS[model], 1, 52).values():
        if item.address not in SENSED_ADDRESSES:
            compare(own, manual, p.instruct(1, p.READ, words(item.address, item.size)))


TRIED_VALUES = (*EDGE_VALUES, -1, -100, -886, -1024, -2048, 16_383, 16_384, 32_767, 32_768, 1_044_480, 1_048_576)


# To limit the duration, each model tests a fraction of the values; together the models test all
@pytest.mark.parametrize("share", [len(TESTED_MODELS), pytest.param(1, marks=pytest.mark.soak)])
@pytest.mark.parametrize("torque", [0, 1])
@pytest.mark.parametrize("model", TESTED_MODELS)
def test_virtual_servos_accept_the_same_register_values_as_the_manual_model(model: str, torque: int, share: int):
    cable = Cable("body", (ServoFitting(1, model=model),))
    own = Host(MemoryWire(build_bus([cable])[1]["body"]))
    manual = Host(ManualWire(build_manual([cable])[1]["body"]))
    for k, (name, item) in enumerate(items(MODELS[model], 1, 52).items()):
        if name in ("id", "baud", "status_return"):
            continue
        for value in TRIED_VALUES[(k + TESTED_MODELS.index(model)) % share :: share]:
            compare(own, manual, p.instruct(1, p.WRITE, words(64) + bytes([torque])))
            octets = (value % 256**item.size).to_bytes(item.size, "little")
            compare(own, manual, p.instruct(1, p.WRITE, words(item.address) + octets))
