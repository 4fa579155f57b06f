"""Telemetry subscriptions over the wire: individual rates and total limit."""

import asyncio

import pytest

from kinesic.serve.desk.requester import Requester
from kinesic.serve.desk.watches import MAX_REPORT_RATE, Watches
from kinesic.serve.messages import BodyReport

pytestmark = pytest.mark.realtime


def reports(rates: list[float], seconds: float) -> list[int]:
    """Return the number of reports for each client."""

    async def watched():
        watches, counts = Watches(lambda: BodyReport(0.0, (), ())), [0] * len(rates)
        for number, rate in enumerate(rates):

            def count(message, number=number):
                counts[number] += 1

            watches.set(Requester(number, count, lambda: True), rate)
        await asyncio.sleep(seconds)
        watches.close()
        return counts

    return asyncio.run(watched())


def test_few_telemetry_subscriptions_get_their_full_rate():
    fast, slow, over = reports([50.0, 10.0, 1000.0], 1.0)
    assert 25 <= fast <= 55
    assert 6 <= slow <= 13
    assert over <= 55


def test_many_telemetry_subscriptions_divide_the_total_rate():
    counts = reports([50.0] * 200, 2.0)
    assert sum(counts) <= 2.0 * MAX_REPORT_RATE + 2 * 200  # plus one at the start of each
    assert min(counts) >= 2


def test_disconnected_client_gets_no_telemetry_report():
    async def watched():
        watches, heard = Watches(lambda: BodyReport(0.0, (), ())), []
        watches.set(Requester(1, heard.append, lambda: not heard), 50.0)
        await asyncio.sleep(0.2)
        return len(heard), watches._task.done()

    assert asyncio.run(watched()) == (1, True)
