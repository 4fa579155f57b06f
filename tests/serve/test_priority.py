"""Threads that go before other work."""

import os
import sys
from threading import Thread

import pytest

from kinesic.serve import priority
from kinesic.serve.priority import URGENT, urgent


def niceness() -> int:
    return os.getpriority(os.PRIO_PROCESS, 0)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere niceness is a process's")
@pytest.mark.skipif(os.geteuid() != 0, reason="only root may go before others")
def test_a_thread_is_urgent_meanwhile_and_no_other_is():
    seen = []

    def work() -> None:
        with urgent():
            seen.append(niceness())
        seen.append(niceness())

    thread = Thread(target=work)
    before = niceness()
    with urgent():
        pass
    thread.start()
    thread.join()
    assert seen == ([URGENT, 0] if before == 0 else [before, before])
    assert niceness() == before


def test_who_may_not_go_before_others_works_all_the_same(monkeypatch):
    def refuse(*_: int) -> None:
        raise PermissionError

    monkeypatch.setattr(priority.os, "setpriority", refuse)
    with urgent():
        worked = True
    assert worked


def test_who_was_made_nice_stays_so(monkeypatch):
    asked = []
    monkeypatch.setattr(priority.os, "getpriority", lambda *_: 5)
    monkeypatch.setattr(priority.os, "setpriority", lambda *given: asked.append(given))
    with urgent():
        pass
    assert asked == []
