"""Independent model of servos with Protocol 1.0 frames and their wire.

It is written from the manuals and shares no code with kinesic. Time is virtual. A servo moves to its goal at a constant
velocity.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

BYTE_BITS = 10  # transmitted bits per byte
ADAPTER_DELAY = 0.001  # [s] latency timer of the adapter
REPLY_PAUSE = 30e-6  # [s] pause of a servo before its reply


@dataclass(frozen=True)
class Layout:
    """Addresses of a family that the test servo needs."""

    model: int
    id: int
    torque: int
    goal: int
    position: int
    volts: int
    celsius: int
    limits: tuple[int, int]  # addresses of lowest and highest position
    volt_limits: tuple[int, int]  # addresses of lowest and highest voltage
    heat_limit: int
    max_torque: int
    status_level: int
    status: int | None = None  # address of the error register
    current_limit: int | None = None
    shutdown: int = 0
    high_byte_first: bool = False
    turn: int = 4096  # position counts per turn
    full_torque: int = 1000


STS = Layout(3, 5, 40, 42, 56, 62, 63, (9, 11), (15, 14), 13, 16, 8, 65, 28, 19)
SCS = Layout(3, 5, 40, 42, 56, 62, 63, (9, 11), (15, 14), 13, 16, 8, 65, None, 19, True, 1024)
AX = Layout(0, 3, 24, 30, 36, 42, 43, (6, 8), (12, 13), 11, 14, 16, shutdown=18, turn=1024, full_torque=1023)
MX = Layout(0, 3, 24, 30, 36, 42, 43, (6, 8), (12, 13), 11, 14, 16, shutdown=18, full_torque=1023)


@dataclass
class FrameDevice:
    """Servo with a table of 256 bytes."""

    layout: Layout
    number: int  # model number
    id: int
    volts: int = 74  # [0.1 V]
    velocity: float = 3000.0  # [counts/s] of the shaft
    silent: bool = False
    answers_as: int | None = None  # wrong id in replies, or None
    errors: int = 0
    table: bytearray = field(default_factory=lambda: bytearray(256))
    place: float = 0.0  # [counts] true position of the shaft

    def __post_init__(self) -> None:
        layout = self.layout
        self.place = layout.turn // 2
        self.put(layout.model, self.number)
        self.table[layout.id] = self.id
        self.put(layout.limits[1], layout.turn - 1)
        self.table[layout.volt_limits[0]], self.table[layout.volt_limits[1]] = self.volts - 25, self.volts + 30
        self.table[layout.heat_limit], self.table[layout.celsius] = 70, 30
        self.put(layout.max_torque, layout.full_torque)
        self.table[layout.status_level] = 2 if layout.model == 0 else 1
        if layout.current_limit is not None:
            self.put(layout.current_limit, 500)
        self.put(layout.goal, int(self.place))

    def put(self, address: int, value: int) -> None:
        low, high = value & 0xFF, value >> 8
        pair = (high, low) if self.layout.high_byte_first else (low, high)
        self.table[address : address + 2] = bytes(pair)

    def get(self, address: int) -> int:
        first, second = self.table[address], self.table[address + 1]
        return first << 8 | second if self.layout.high_byte_first else second << 8 | first

    @property
    def torque(self) -> bool:
        return bool(self.table[self.layout.torque])

    def fail(self, bits: int) -> None:
        """Report errors; those of the shutdown mask switch torque off."""
        self.errors |= bits
        if bits & self.table[self.layout.shutdown]:
            self.table[self.layout.torque] = 0

    def move(self, seconds: float) -> None:
        if self.torque:
            step = self.velocity * seconds
            self.place += max(-step, min(step, self.get(self.layout.goal) - self.place))
        self.put(self.layout.position, round(self.place))
        self.table[self.layout.volts] = self.volts
        if self.layout.status is not None:
            self.table[self.layout.status] = self.errors

    def status(self, data: bytes = b"") -> bytes:
        name = self.id if self.answers_as is None else self.answers_as
        body = bytes([name, len(data) + 2, self.errors]) + data
        return b"\xff\xff" + body + bytes([255 - sum(body) % 256])

    def store(self, address: int, data: bytes) -> None:
        self.table[address : address + len(data)] = data
        self.id = self.table[self.layout.id]


class FrameLine:
    """Half-duplex wire with servos, in virtual time."""

    def __init__(self, devices: Sequence[FrameDevice], baud: int = 1_000_000) -> None:
        self.devices, self.baud, self.name = list(devices), baud, "independent"
        self.time, self._free = 0.0, 0.0  # [s] now, and end of the last transmission
        self._coming: list[tuple[float, bytes]] = []
        self._moved = 0.0  # [s] time of the shafts
        self.plugged = True
        self.lost: type[Exception] = OSError  # exception of an unplugged port
        self.damage: Callable[[bytes], bytes] = lambda data: data  # change of each reply

    def now(self) -> float:
        return self.time

    def sleep(self, until: float) -> None:
        self.time = max(self.time, until)

    def close(self) -> None:
        """Leave the line open, because it is in memory."""

    def reopen(self) -> bool:
        return self.plugged

    def advance(self, time: float) -> None:
        if time > self._moved:
            for device in self.devices:
                device.move(time - self._moved)
            self._moved = time

    def write(self, data: bytes | bytearray) -> None:
        self._check()
        rest, clock = bytes(data), max(self.time, self._free)
        while len(rest) >= 6:
            if rest[:2] != b"\xff\xff":
                rest = rest[1:]
                continue
            size = rest[3] + 4
            sent, rest = rest[:size], rest[size:]
            clock += size * BYTE_BITS / self.baud
            self.advance(clock)
            if sum(sent[2:]) % 256 == 255:
                clock = self._answer(sent[2], sent[4], sent[5:-1], clock)
        self._free = clock

    def read(self, deadline: float) -> bytes:
        self._check()
        if self._coming and self._coming[0][0] <= max(deadline, self.time):
            arrival, data = self._coming.pop(0)
            self.time = max(self.time, arrival)
            return data
        self.time = max(self.time, deadline)
        return b""

    def _check(self) -> None:
        if not self.plugged:
            self._coming.clear()
            raise self.lost("the port is gone")

    def _answer(self, target: int, instruction: int, parameters: bytes, clock: float) -> float:
        replies: list[bytes] = []
        if instruction == 0x83:
            address, size, rows = parameters[0], parameters[1], parameters[2:]
            for k in range(0, len(rows), size + 1):
                for device in self._at(rows[k]):
                    device.store(address, rows[k + 1 : k + 1 + size])
        elif instruction in (0x82, 0x92):
            spans = [(parameters[0], parameters[1], name) for name in parameters[2:]]
            if instruction == 0x92:
                rows = parameters[1:]
                spans = [(rows[k + 2], rows[k], rows[k + 1]) for k in range(0, len(rows), 3)]
            for address, size, name in spans:
                replies += [d.status(bytes(d.table[address : address + size])) for d in self._at(name) if not d.silent]
        else:
            in_order = sorted(self.devices, key=lambda device: device.id)
            for device in in_order if target == 0xFE else self._at(target):
                data = b""
                if instruction == 2:
                    data = bytes(device.table[parameters[0] : parameters[0] + parameters[1]])
                reply = device.status(data)
                if instruction == 3:
                    device.store(parameters[0], parameters[1:])
                if (target != 0xFE or instruction == 1) and not device.silent:  # all servos answer a ping
                    replies.append(reply)
        for reply in replies:
            clock += REPLY_PAUSE + len(reply) * BYTE_BITS / self.baud
            if damaged := self.damage(reply):
                self._coming.append((clock + ADAPTER_DELAY, damaged))
        return clock

    def _at(self, name: int) -> list[FrameDevice]:
        return [device for device in self.devices if device.id == name]
