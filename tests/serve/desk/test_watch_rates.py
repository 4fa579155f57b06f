"""Watching in simulated time: who is told how often, and who no longer."""

import asyncio
import json
from collections.abc import Callable, Coroutine

import pytest

from kinesic.serve.desk import watches as module
from kinesic.serve.desk.asker import Asker
from kinesic.serve.desk.watches import MOST_RATE, MOST_REPORTS, Watches
from kinesic.serve.messages import BodyReport


class Room:
    """Watches, and the reports that every client got, with their times [s]."""

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

        self.watches.set(Asker(number, tell, lambda: number not in self.gone), rate)

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


@pytest.mark.parametrize(("rate", "reports"), [(10.0, 10), (0.5, 1), (MOST_RATE, 50), (1000.0, 50)])
def test_each_is_told_at_its_rate_up_to_the_greatest(play: Callable, rate: float, reports: int):
    async def act(room: Room) -> None:
        room.watch(1, rate)
        await room.until(1.0)
        assert len(room.told[1]) == pytest.approx(reports, abs=max(1, 0.1 * reports))
        assert room.told[1][0] == 0.0, "at once"

    play(act)


def test_two_have_each_their_own_rate_and_one_look_serves_both(play: Callable):
    async def act(room: Room) -> None:
        room.watch(1, 10.0)
        room.watch(2, 10.0)
        room.watch(3, 2.0)
        await room.until(2.0)
        assert len(room.told[1]) == len(room.told[2]) == pytest.approx(20, abs=2)
        assert len(room.told[3]) == pytest.approx(4, abs=1)
        assert room.looks <= 22

    play(act)


def test_many_share_what_there_is(play: Callable):
    async def act(room: Room) -> None:
        for number in range(200):
            room.watch(number, 50.0)
        await room.until(4.0)
        counts = [len(times) for times in room.told.values()]
        assert sum(counts) == pytest.approx(4.0 * MOST_REPORTS, rel=0.15)
        assert max(counts) - min(counts) <= 1

    play(act)


@pytest.mark.parametrize("rate", [0.0, -1.0])
def test_a_rate_of_nothing_ends_it(play: Callable, rate: float):
    async def act(room: Room) -> None:
        room.watch(1, 10.0)
        room.watch(2, 10.0)
        await room.until(0.5)
        room.watch(1, rate)
        room.watch(9, rate)
        told = len(room.told[1])
        await room.until(1.0)
        assert len(room.told[1]) == told
        assert len(room.told[2]) > told
        assert not room.told[9]

    play(act)


def test_a_new_rate_takes_the_place_of_the_old_one(play: Callable):
    async def act(room: Room) -> None:
        room.watch(1, 50.0)
        await room.until(1.0)
        room.watch(1, 2.0)
        before = len(room.told[1])
        await room.until(3.0)
        assert len(room.told[1]) - before == pytest.approx(4, abs=1)

    play(act)


def test_who_has_gone_is_told_nothing_and_the_others_are(play: Callable):
    async def act(room: Room) -> None:
        room.watch(1, 10.0)
        room.watch(2, 10.0)
        await room.until(0.5)
        room.gone.add(1)
        told = len(room.told[1])
        await room.until(1.0)
        assert len(room.told[1]) == told
        assert len(room.told[2]) > told
        room.gone.add(2)
        await room.until(5.0)
        assert room.time < 2.0, "nobody is left, and nothing is looked at"
        room.watch(3, 10.0)
        begin = room.time
        await room.until(begin + 1.0)
        assert len(room.told[3]) == pytest.approx(10, abs=1), "it begins anew"

    play(act)


def test_whoever_was_held_up_is_not_told_more_often_for_that(play: Callable):
    async def act(room: Room) -> None:
        room.watch(1, 10.0)
        await room.until(0.5)
        room.time += 10.0
        begin = room.time
        await room.until(begin + 1.0)
        assert sum(time > begin for time in room.told[1]) <= 12

    play(act)


def test_nobody_is_told_after_the_end(play: Callable):
    async def act(room: Room) -> None:
        room.watches.close()
        room.watch(1, 10.0)
        await room.until(0.3)
        room.watches.close()
        told = len(room.told[1])
        await room.until(1.0)
        assert len(room.told[1]) == told

    play(act)
