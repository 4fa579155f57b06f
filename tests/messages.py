"""Fewer messages from test processes to the process that prints their results.

For each test, xdist sends six messages, which take 4 ms of processor time, as much as most tests take. Short output
needs only two of them: the result, and that the test is over. pytest-rerunfailures also asks for the number of attempts
over TCP, where each test waits 40 ms for a delayed acknowledgement. Each process therefore counts attempts by itself.
"""

from collections.abc import Mapping

import pytest
from pytest_rerunfailures import StatusDB

UNPRINTED_EVENTS = frozenset({"logstart", "logfinish"})  # events that only verbose output prints


def send_few_messages(config: pytest.Config) -> None:
    """Send only messages that the requested output needs, in a process of xdist."""
    if not hasattr(config, "workerinput"):
        return
    config.failures_db.sock.close()
    config.failures_db = StatusDB()  # attempts are counted here; a test that ends its process is not tried again
    if not uses_short_output(config):
        return
    sender = next(plugin for plugin in config.pluginmanager.get_plugins() if hasattr(plugin, "sendevent"))
    send = sender.sendevent

    def send_needed(name: str, **content: object) -> None:
        if is_needed(name, content):
            send(name, **content)

    sender.sendevent = send_needed


def uses_short_output(config: pytest.Config) -> bool:
    """Return whether neither details of each test nor durations are printed."""
    option = config.option
    return option.verbose <= 0 and not option.durations and not option.xmlpath


def is_needed(name: str, content: Mapping[str, object]) -> bool:
    """Return whether the main test process uses a worker's message."""
    if name != "testreport":
        return name not in UNPRINTED_EVENTS
    report = content["data"]
    return report["when"] == "call" or report["outcome"] != "passed"
