import click
import pytest

from kinesic.cli.many.workers import Workers
from kinesic.tasks.engine import Processes, engine_in_use


def test_without_options_processes_of_this_machine_do_all_tasks_meanwhile():
    before = engine_in_use()
    with Workers(3, None).engine() as engine:
        assert engine_in_use() is engine
        assert engine == Processes(3)
        assert engine.place == "3 processes"
    assert engine_in_use() == before


def test_two_ways_at_once_are_refused():
    with pytest.raises(click.UsageError, match="say one of them"), Workers(2, "local:2").engine():
        pass
