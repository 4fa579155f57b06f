"""Signals that end a performance on servos: SIGINT, SIGTERM, SIGHUP."""

import os
import signal

import pytest

from kinesic.controller.servo_performance import catch_interrupts
from kinesic.host import ENDING_SIGNALS


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_interrupt_signal_is_reported_once_and_does_not_end_the_process(number: signal.Signals):
    before = [signal.getsignal(ending) for ending in ENDING_SIGNALS]
    with catch_interrupts() as asked:
        assert not asked()
        os.kill(os.getpid(), number)
        assert asked()
        assert not asked()
    assert [signal.getsignal(ending) for ending in ENDING_SIGNALS] == before


def test_hangup_signal_ignored_by_the_caller_is_not_caught():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with catch_interrupts() as asked:
            os.kill(os.getpid(), signal.SIGHUP)
            assert not asked()
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)
