"""Threads with a higher scheduling priority."""

import os
import sys
from threading import Thread

import pytest

from kinesic.serve import priority
from kinesic.serve.priority import URGENT_NICENESS, raise_priority


def niceness() -> int:
    return os.getpriority(os.PRIO_PROCESS, 0)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere niceness is a process's")
@pytest.mark.skipif(os.geteuid() != 0, reason="only root may go before others")
def test_only_the_calling_thread_gets_a_higher_priority():
    seen = []

    def work() -> None:
        with raise_priority():
            seen.append(niceness())
        seen.append(niceness())

    thread = Thread(target=work)
    before = niceness()
    with raise_priority():
        pass
    thread.start()
    thread.join()
    assert seen == ([URGENT_NICENESS, 0] if before == 0 else [before, before])
    assert niceness() == before


def test_missing_privilege_for_priority_is_ignored(monkeypatch):
    def refuse(*_: int) -> None:
        raise PermissionError

    monkeypatch.setattr(priority.os, "setpriority", refuse)
    with raise_priority():
        worked = True
    assert worked


def test_thread_priority_is_not_raised_if_the_niceness_of_the_process_was_changed(monkeypatch):
    asked = []
    monkeypatch.setattr(priority.os, "getpriority", lambda *_: 5)
    monkeypatch.setattr(priority.os, "setpriority", lambda *given: asked.append(given))
    with raise_priority():
        pass
    assert asked == []
