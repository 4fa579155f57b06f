"""What ends a performance on servos by folding: Ctrl-C, SIGTERM, and a terminal that closes."""

import os
import signal

import pytest

from kinesic.controller.servo_performance import ENDING, interrupted


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_each_is_told_once_and_ends_no_process(number: signal.Signals):
    before = [signal.getsignal(ending) for ending in ENDING]
    with interrupted() as asked:
        assert not asked()
        os.kill(os.getpid(), number)
        assert asked()
        assert not asked()
    assert [signal.getsignal(ending) for ending in ENDING] == before


def test_what_is_ignored_stays_so():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with interrupted() as asked:
            os.kill(os.getpid(), signal.SIGHUP)
            assert not asked()
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)
