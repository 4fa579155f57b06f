"""Telemetry subscriptions in simulated time: rates and ends."""

import asyncio
import json
from collections.abc import Callable, Coroutine

import pytest

from kinesic.serve.desk import watches as module
from kinesic.serve.desk.requester import Requester
from kinesic.serve.desk.watches import MAX_REPORT_RATE, MAX_WATCH_RATE, Watches
from kinesic.serve.messages import BodyReport


class Room:
    """Subscriptions and the reports of each client with their times [s]."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.time, self.looks, self.told = 0.0, 0, dict[int, list[float]]()
        self.gone: set[int] = set()
        self.watches = Watches(self.look)
        self._really = asyncio.sleep

        async def sleep(seconds: float) -> None:
            assert seconds > 0.0
            self.time += seconds
            await self._really(0)

        monkeypatch.setattr(module, "monotonic", lambda: self.time)
        monkeypatch.setattr(module, "sleep", sleep)

    def look(self) -> BodyReport:
        self.looks += 1
        return BodyReport(self.time, (0.1,), (0.2,))

    def watch(self, number: int, rate: float) -> None:
        times = self.told.setdefault(number, [])

        def tell(message: str) -> None:
            report = json.loads(message)
            assert (report["told"], report["time"], report["angles"]) == ("body", self.time, [0.1])
            times.append(self.time)

        self.watches.set(Requester(number, tell, lambda: number not in self.gone), rate)

    async def until(self, time: float) -> None:
        while self.time < time and any(not task.done() for task in asyncio.all_tasks() - {asyncio.current_task()}):
            await self._really(0)


@pytest.fixture
def play(monkeypatch: pytest.MonkeyPatch) -> Callable:
    def run(act: Callable[[Room], Coroutine]) -> None:
        async def whole() -> None:
            room = Room(monkeypatch)
            await act(room)
            room.watches.close()

        asyncio.run(whole())

    return run


@pytest.mark.parametrize(("rate", "reports"), [(10.0, 10), (0.5, 1), (MAX_WATCH_RATE, 50), (1000.0, 50)])
def test_telemetry_subscription_reports_at_its_rate_up_to_the_maximum(play: Callable, rate: float, reports: int):
    async def act(room: Room) -> None:
        room.watch(1, rate)
        await room.until(1.0)
        assert len(room.told[1]) == pytest.approx(reports, abs=max(1, 0.1 * reports))
        assert room.told[1][0] == 0.0, "at once"

    play(act)


def test_subscriptions_with_different_rates_read_the_body_state_only_once_per_period(play: Callable):
    async def act(room: Room) -> None:
        room.watch(1, 10.0)
        room.watch(2, 10.0)
        room.watch(3, 2.0)
        await room.until(2.0)
        assert len(room.told[1]) == len(room.told[2]) == pytest.approx(20, abs=2)
        assert len(room.told[3]) == pytest.approx(4, abs=1)
        assert room.looks <= 22

    play(act)


def test_telemetry_reports_of_different_rates_are_at_most_5_ms_late(play: Callable):
    rates = {1: 50.0, 2: 40.0, 3: 27.0}

    async def act(room: Room) -> None:
        for number, rate in rates.items():
            room.watch(number, rate)
        await room.until(2.0)
        for number, rate in rates.items():
            delays = [time - k / rate for k, time in enumerate(room.told[number])]
            assert -1e-9 <= min(delays) <= max(delays) <= 0.005 + 1e-9

    play(act)


def test_many_telemetry_subscriptions_divide_the_total_rate(play: Callable):
    async def act(room: Room) -> None:
        for number in range(200):
            room.watch(number, 50.0)
        await room.until(4.0)
        counts = [len(times) for times in room.told.values()]
        assert sum(counts) == pytest.approx(4.0 * MAX_REPORT_RATE, rel=0.15)
        assert max(counts) - min(counts) <= 1

    play(act)


@pytest.mark.parametrize("rate", [0.0, -1.0])
def test_zero_or_negative_rate_ends_a_telemetry_subscription(play: Callable, rate: float):
    async def act(room: Room) -> None:
        room.watch(1, 10.0)
        room.watch(2, 10.0)
        await room.until(0.5)
        room.watch(1, rate)
        room.watch(9, rate)
        count = len(room.told[1])
        await room.until(1.0)
        assert len(room.told[1]) == count
        assert len(room.told[2]) > count
        assert not room.told[9]

    play(act)


def test_new_telemetry_rate_replaces_the_old_one(play: Callable):
    async def act(room: Room) -> None:
        room.watch(1, 50.0)
        await room.until(1.0)
        room.watch(1, 2.0)
        before = len(room.told[1])
        await room.until(3.0)
        assert len(room.told[1]) - before == pytest.approx(4, abs=1)

    play(act)


def test_disconnected_client_gets_no_telemetry_report_but_others_do(play: Callable):
    async def act(room: Room) -> None:
        room.watch(1, 10.0)
        room.watch(2, 10.0)
        await room.until(0.5)
        room.gone.add(1)
        count = len(room.told[1])
        await room.until(1.0)
        assert len(room.told[1]) == count
        assert len(room.told[2]) > count
        room.gone.add(2)
        await room.until(5.0)
        assert room.time < 2.0, "nobody is left, and nothing is looked at"
        room.watch(3, 10.0)
        begin = room.time
        await room.until(begin + 1.0)
        assert len(room.told[3]) == pytest.approx(10, abs=1), "it begins anew"

    play(act)


def test_telemetry_reports_missed_during_a_delay_are_not_sent_later(play: Callable):
    async def act(room: Room) -> None:
        room.watch(1, 10.0)
        await room.until(0.5)
        room.time += 10.0
        begin = room.time
        await room.until(begin + 1.0)
        assert sum(time > begin for time in room.told[1]) <= 12

    play(act)


def test_telemetry_ends_when_the_subscriptions_are_closed(play: Callable):
    async def act(room: Room) -> None:
        room.watches.close()
        room.watch(1, 10.0)
        await room.until(0.3)
        room.watches.close()
        count = len(room.told[1])
        await room.until(1.0)
        assert len(room.told[1]) == count

    play(act)
