"""What a wire does to the bytes that pass it, by the plan's faults and its seed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from random import Random

from kinesic.hardware.virtual.faults import WIRE_KINDS, FaultPlan, PlannedFault
from kinesic.hardware.virtual.protocol import Sent


@dataclass(frozen=True)
class Transmission:
    """What arrives of one transmission."""

    data: bytes
    delay: float  # [s] of silence before
    late: float = 0.0  # [s] that the host gets it later


class WireFaults:
    """Faults of one wire; the same seed and traffic meet the same faults."""

    def __init__(self, plan: FaultPlan, *, since: float = 0.0) -> None:
        """Begins.

        Args:
            plan: what goes wrong.
            since: [s] where the plan's times count from.
        """
        self._since = since
        mishaps = plan.of(WIRE_KINDS)
        self._on_replies = tuple(mishap for mishap in mishaps if mishap.way == "reply")
        self._on_requests = tuple(mishap for mishap in mishaps if mishap.way == "request")
        self._random = Random(plan.seed)

    def request(self, data: bytes, time: float) -> bytes:
        """What the servos hear of what the host says."""
        for mishap in self._on_requests:
            if mishap.start <= time - self._since < mishap.end and self._random.random() < mishap.rate:
                data = self._struck(mishap, data)
        return data

    def replies(self, sent: Sequence[Sent], time: float) -> list[Transmission]:
        """What the host hears of the answer to one instruction, be it one status or several, or a joint reply.

        A fault strikes one place of it. Who waits in vain for the bytes before his own keeps silent.
        """
        heard = [Transmission(answer.data, answer.delay) for answer in sent]
        end = len(sent)
        for mishap in self._on_replies:
            struck = [k for k, answer in enumerate(sent) if mishap.strikes(answer.servo, time - self._since)]
            if not struck or self._random.random() >= mishap.rate:
                continue
            if mishap.kind == "late":
                k = struck[0]
                heard[k] = replace(heard[k], late=heard[k].late + mishap.figure)
                continue
            k = self._random.choice(struck)
            heard[k] = replace(heard[k], data=self._struck(mishap, heard[k].data))
            if mishap.kind == "lost" and sent[k].chained:
                end = min(end, k)
        return [part for part in heard[:end] if part.data]

    def _struck(self, mishap: PlannedFault, data: bytes) -> bytes:
        """Bytes after a fault."""
        dice = self._random
        if mishap.kind == "noise":
            return dice.randbytes(dice.randint(1, max(1, int(mishap.figure)))) + data
        if mishap.kind == "duplicate":
            return data + data
        if mishap.kind == "lost" or not data:
            return b""
        place = dice.randrange(len(data))
        if mishap.kind == "truncate":
            return data[:place]
        changed = bytes((data[place] ^ dice.randint(1, 255),)) if mishap.kind == "corrupt" else b""
        return data[:place] + changed + data[place + 1 :]
