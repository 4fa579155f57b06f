"""Half-duplex wire with servos, paced by its baud rate.

The caller owns the clock of its world.
"""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from heapq import heappop, heappush
from itertools import count
from math import inf

from . import packet as p
from .device import FIRST_UNUSED_ID, Answer, Device
from .faults import Fault
from .packet import Decoder, Packet
from .physics import Arm

TIME_STEP = 0.001  # [s] time step of the servos' control loop
BITS_PER_BYTE = 10  # bits on the wire per byte, with start and stop bit
BURST_SIZE = 62  # [bytes] amount that the adapter delivers at once; fewer bytes wait for its latency timer
BULK_READS = (p.BULK_READ, p.FAST_BULK_READ)
GROUP_READS = (p.SYNC_READ, p.FAST_SYNC_READ, *BULK_READS)
GROUP_WRITES = (p.SYNC_WRITE, p.BULK_WRITE)


class World:
    """Servos of all wires with their loads, under one clock."""

    def __init__(self, devices: Sequence[Device] = (), arms: Sequence[Arm] = ()) -> None:
        self.time, self.devices, self.arms = 0.0, tuple(devices), tuple(arms)
        self._alarms: list[tuple[float, int, Callable[[], None]]] = []
        self._numbers = count()

    def call(self, time: float, deed: Callable[[], None]) -> None:
        """Schedule a call at a clock time [s]."""
        heappush(self._alarms, (time, next(self._numbers), deed))

    def advance(self, time: float) -> None:
        """Advance the clock, which never decreases."""
        while True:
            self._ring()
            if self.time + TIME_STEP > time + 1e-12:
                return
            for arm in self.arms:
                arm.pull()
            for device in self.devices:
                device.firmware.run(TIME_STEP)
            self.time += TIME_STEP

    def _ring(self) -> None:
        while self._alarms and self._alarms[0][0] <= self.time + 1e-12:
            heappop(self._alarms)[2]()


class Line:
    """Wire that buffers the servos' replies until the host reads them."""

    def __init__(
        self, world: World, devices: Sequence[Device], *, baud: int = 1_000_000, latency: float = 0.001
    ) -> None:
        """Create a wire in a world with an adapter latency [s]."""
        self.world, self.devices, self.baud, self.latency = world, list(devices), baud, latency
        self.plugged = True
        self.faults: list[Fault] = []
        self._decoder = Decoder()
        self._coming: deque[tuple[float, bytes]] = deque()
        self._busy, self._piece = 0.0, bytearray()

    def expose(self, fault: Fault, *, at: float | None = None, seconds: float = inf) -> None:
        """Apply a fault, now or later, for a duration."""
        begin = self.world.time if at is None else at

        def strike() -> None:
            self.faults.append(fault)
            fault.begin(self)

        def pass_by() -> None:
            self.faults.remove(fault)
            fault.end(self)

        self.world.call(begin, strike)
        if seconds < inf:
            self.world.call(begin + seconds, pass_by)
        self.world.advance(self.world.time)

    def device(self, servo: int) -> Device:
        """Return the first servo that was built with the given id."""
        return next(device for device in self.devices if device.id == servo)

    def drop(self) -> None:
        """Discard all bytes on their way to the host."""
        self._coming.clear()

    # the host's side

    def send(self, data: bytes, time: float) -> None:
        """Take bytes from the host at a time [s]."""
        end = max(time, self._busy) + self._lasts(data)
        self.world.advance(end)
        self._busy = end
        for fault in self.faults:
            fault.echo(self, data, end)
        for fault in self.faults:
            data = fault.request(data)
        for packet in self._decoder.feed(data, end):
            if packet.instruction != p.STATUS:
                self._busy = self._flush(self._respond(packet, end))

    def arrives(self) -> float:
        """Return the time [s] of the next arrival, or infinity."""
        return self._coming[0][0] if self._coming else inf

    def receive(self, time: float) -> bytes:
        """Return all bytes that have arrived by a time [s]."""
        result = b""
        while self._coming and self._coming[0][0] <= time:
            result += self._coming.popleft()[1]
        return result

    def post(self, data: bytes, time: float) -> None:
        """Deliver bytes to the host at a time [s], in order."""
        self._coming.append((max(time, self._coming[-1][0]) if self._coming else time, data))

    # the servos' side

    def _lasts(self, data: bytes) -> float:
        return len(data) * BITS_PER_BYTE / self.baud

    def _awake(self, time: float) -> Iterator[Device]:
        return (device for device in self.devices if device.awake(time) and device.baud == self.baud)

    def _respond(self, packet: Packet, time: float) -> float:
        """Execute an instruction on all servos, and return the end of their replies."""
        awake = list(self._awake(time))
        if packet.instruction in GROUP_READS + GROUP_WRITES and packet.intact:
            for device in awake:
                device.firmware.heard = device.firmware.time
            if packet.servo != p.BROADCAST_ID:
                return time
            if packet.instruction in GROUP_WRITES:
                self._write(packet, awake)
                return time
            fast = packet.instruction in (p.FAST_SYNC_READ, p.FAST_BULK_READ)
            return self._fast(packet, awake, time) if fast else self._read(packet, awake, time)
        answers = [(device, device.hear(packet, device.firmware.time)) for device in awake]
        given = sorted(
            ((device, answer) for device, answer in answers if answer is not None), key=lambda pair: pair[1].servo
        )
        return self._say_all(given, time)

    def _say_all(self, given: Sequence[tuple[Device, Answer]], time: float) -> float:
        """Transmit replies in turn, and replies of servos with equal ids at once."""
        at = 0
        while at < len(given):
            same = [pair for pair in given[at:] if pair[1].servo == given[at][1].servo]
            at += len(same)
            said = [self._packed(device, answer) for device, answer in same]
            said = [data for data in said if data]
            if said:
                time = self._carry(same[0][0], _collide(said), time)
        return time

    def _packed(self, device: Device, answer: Answer) -> bytes:
        result = self._told(device, answer)
        if result is None:
            return b""
        data = p.status(result.servo, result.error, result.parameters)
        for fault in self.faults:
            data = fault.frame(device, data)
        return data

    def _told(self, device: Device, answer: Answer | None) -> Answer | None:
        """Return a servo's reply after the changes by all faults."""
        if device.mute:
            return None
        for fault in self.faults:
            answer = fault.say(device, answer) if answer is not None else None
        return answer

    def _carry(self, device: Device, data: bytes, time: float) -> float:
        """Transmit a servo's bytes, and return their end time."""
        end = time + device.delay + self._lasts(data)
        flying = [(0.0, data)]
        for fault in self.faults:
            flying = [(late + more, part) for late, whole in flying for more, part in fault.carry(device, whole)]
        for late, part in flying:
            if late:
                self.post(part, end + self.latency + late)
            else:
                self._piece += part
        while len(self._piece) >= BURST_SIZE:
            self.post(bytes(self._piece[:BURST_SIZE]), end)
            del self._piece[:BURST_SIZE]
        return end

    def _flush(self, time: float) -> float:
        """Deliver the adapter's remaining bytes."""
        if self._piece:
            self.post(bytes(self._piece), time + self.latency)
            self._piece.clear()
        return time

    def _write(self, packet: Packet, awake: Sequence[Device]) -> None:
        for servo, address, data in writes_of(packet):
            for device in awake:
                if servo == device.id:
                    device.write(address, data)
                elif servo == device.memory["secondary_id"] < FIRST_UNUSED_ID:
                    device.write(address, data, shadow=True)

    def _read(self, packet: Packet, awake: Sequence[Device], time: float) -> float:
        """Return the replies in list order, up to the first silent servo."""
        for servo, address, size in _reads(packet):
            mine = [device for device in awake if device.id == servo and device.memory["status_return"]]
            said = [self._packed(device, device.answer(*device.show(address, size))) for device in mine]
            said = [data for data in said if data]
            if not said:
                break
            time = self._carry(mine[0], _collide(said), time)
        return time

    def _fast(self, packet: Packet, awake: Sequence[Device], time: float) -> float:
        """Return the combined reply of several servos, whose blocks end with a running CRC."""
        wanted = list(_reads(packet))
        size = 1 + sum(size + 4 for _, _, size in wanted)
        head = p.PACKET_HEADER + bytes([p.BROADCAST_ID]) + size.to_bytes(2, "little") + bytes([p.STATUS])
        before = p.crc(head)
        for servo, address, size in wanted:
            mine = [device for device in awake if device.id == servo and device.fast and device.memory["status_return"]]
            answers = [self._told(device, _padded(device, address, size)) for device in mine]
            bodies = [bytes([a.error, a.servo]) + a.parameters for a in answers if a is not None]
            if not bodies:
                break
            block = _collide([body + p.crc(body, before).to_bytes(2, "little") for body in bodies])
            before, block, head = p.crc(block, before), head + block, b""
            for fault in self.faults:
                block = fault.frame(mine[0], block)
            time = self._carry(mine[0], block, time)
        return time


def _padded(device: Device, address: int, size: int) -> Answer:
    """Pad a servo's block of a combined reply to its size."""
    error, data = device.show(address, size)
    return device.answer(error, data.ljust(size, b"\0"))


def _collide(said: Sequence[bytes]) -> bytes:
    """Mix simultaneous transmissions, in which low levels win."""
    if len(said) == 1:
        return said[0]
    heard = bytearray(max(said, key=len))
    for other in said:
        for k, byte in enumerate(other):
            heard[k] &= byte
    return bytes(heard)


def _word(data: bytes, at: int) -> int:
    return int.from_bytes(data[at : at + 2], "little")


def _reads(packet: Packet) -> Iterator[tuple[int, int, int]]:
    """List id, address and size of each read."""
    said = packet.parameters
    if packet.instruction in BULK_READS:
        for at in range(0, len(said) - 4, 5):
            yield said[at], _word(said, at + 1), _word(said, at + 3)
    elif len(said) > 4:
        for servo in said[4:]:
            yield servo, _word(said, 0), _word(said, 2)


def writes_of(packet: Packet) -> Iterator[tuple[int, int, bytes]]:
    """List id, address and bytes of each write."""
    said, at = packet.parameters, 0
    if packet.instruction == p.WRITE and len(said) > 2:
        yield packet.servo, _word(said, 0), said[2:]
    elif packet.instruction == p.BULK_WRITE:
        while at + 5 <= len(said):
            size = _word(said, at + 3)
            if len(data := said[at + 5 : at + 5 + size]) == size:
                yield said[at], _word(said, at + 1), data
            at += 5 + size
    elif packet.instruction == p.SYNC_WRITE and len(said) > 4:
        size = _word(said, 2)
        for at in range(4, len(said) - size, size + 1):
            yield said[at], _word(said, 0), said[at + 1 : at + 1 + size]
