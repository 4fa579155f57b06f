"""Watching: each at its rate, and all of them together no more often than the server can afford."""

import asyncio

import pytest

from kinesic.serve.desk.asker import Asker
from kinesic.serve.desk.watches import MOST_REPORTS, Watches
from kinesic.serve.messages import BodyReport

pytestmark = pytest.mark.realtime


def reports(rates: list[float], seconds: float) -> list[int]:
    """How many reports each client got."""

    async def watched():
        watches, counts = Watches(lambda: BodyReport(0.0, (), ())), [0] * len(rates)
        for number, rate in enumerate(rates):

            def count(message, number=number):
                counts[number] += 1

            watches.set(Asker(number, count, lambda: True), rate)
        await asyncio.sleep(seconds)
        watches.close()
        return counts

    return asyncio.run(watched())


def test_a_few_watch_as_often_as_they_like():
    fast, slow, over = reports([50.0, 10.0, 1000.0], 1.0)
    assert 25 <= fast <= 55
    assert 6 <= slow <= 13
    assert over <= 55


def test_many_share_what_there_is():
    counts = reports([50.0] * 200, 2.0)
    assert sum(counts) <= 2.0 * MOST_REPORTS + 2 * 200  # and one each at the beginning
    assert min(counts) >= 2


def test_who_has_gone_is_told_nothing():
    async def watched():
        watches, heard = Watches(lambda: BodyReport(0.0, (), ())), []
        watches.set(Asker(1, heard.append, lambda: not heard), 50.0)
        await asyncio.sleep(0.2)
        return len(heard), watches._task.done()

    assert asyncio.run(watched()) == (1, True)
