"""Helper processes: limited waiting time for clients, none for others."""

import asyncio
import importlib
import time
from dataclasses import replace

import pytest

from kinesic.serve.desk import helper
from kinesic.serve.desk.helper import Helper, Unanswered
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS
from kinesic.session.setup import set_up

pytestmark = pytest.mark.realtime

SHORT_QUOTAS = replace(DEFAULT_QUOTAS, planning=1.0)  # quotas with a short time limit for answers [s]
LONG_TEXT = "x" * 900_000  # text that does not fit into the buffer of a pipe


ANSWER_MODULE = """
import time

def never_set_up():
    time.sleep(600.0)

def echo(question, setup, rules):
    if question.startswith("sleep"):
        time.sleep(float(question.split()[1]))
    return f"{len(question)} {setup.robot.name}"

def fail(question, setup, rules):
    raise SystemExit(3)
"""


@pytest.fixture
def work(tmp_path, monkeypatch):
    """Functions for helper processes, in an importable module."""
    (tmp_path / "answers_of_helpers.py").write_text(ANSWER_MODULE)
    monkeypatch.syspath_prepend(tmp_path)
    return importlib.import_module("answers_of_helpers")


def ask_all(asked: Helper, questions, *, seconds: float = 30.0):
    """Return all answers, and the longest delay [s] of other tasks."""

    async def all_of_them():
        answers, longest = {}, 0.0
        for number, (client, text, rest) in enumerate(questions):
            asked.ask(client, text, lambda found, number=number: answers.setdefault(number, found))
            await asyncio.sleep(rest)
        end = time.monotonic() + seconds
        while len(answers) < len(questions) and time.monotonic() < end:
            before = time.monotonic()
            await asyncio.sleep(0.001)
            longest = max(longest, time.monotonic() - before)
        asked.close()
        return [answers.get(number) for number in range(len(questions))], longest

    return asyncio.run(all_of_them())


def test_queries_to_a_helper_that_never_starts_fail_without_blocking_the_event_loop(work, monkeypatch):
    monkeypatch.setattr(helper, "SETUP_TIMEOUT", 1.0)
    asked = Helper(work.never_set_up, work.echo, SHORT_QUOTAS, name="stuck")
    answers, longest = ask_all(asked, [(1, LONG_TEXT, 0.0), (2, LONG_TEXT, 0.0)])
    assert answers == [Unanswered.FAILED] * 2
    assert longest < 0.5


def test_helper_answer_beyond_its_time_limit_fails_only_the_query_that_caused_it(work):
    asked = Helper(set_up, work.echo, SHORT_QUOTAS, name="slow")
    answers, longest = ask_all(asked, [(1, "sleep 600", 0.0), (2, "quick", 0.0)])
    assert answers == [Unanswered.FAILED, "5 upper22"]
    assert longest < 0.5


def test_helper_answers_the_newest_waiting_query_of_each_client_in_turn(work):
    asked = Helper(set_up, work.echo, DEFAULT_QUOTAS, name="newest")
    questions = [(1, "sleep 0.3", 0.1), (1, "a", 0.0), (2, "bb", 0.0), (1, "ccc", 0.0), (1, "dddd", 0.0)]
    answers, _ = ask_all(asked, questions)
    assert answers == ["9 upper22", Unanswered.OUTDATED, "2 upper22", Unanswered.OUTDATED, "4 upper22"]


def test_queries_fail_if_their_helper_process_dies(work):
    asked = Helper(set_up, work.fail, DEFAULT_QUOTAS, name="dying")
    answers, _ = ask_all(asked, [(1, "a", 0.0), (2, "b", 0.0)])
    assert answers == [Unanswered.FAILED] * 2
