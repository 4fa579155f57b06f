import click
import pytest

from kinesic.cli.many.workers import Workers
from kinesic.tasks.engine import Processes, current_engine


def test_tasks_of_a_command_run_in_local_processes_by_default():
    before = current_engine()
    with Workers(3, None).engine() as engine:
        assert current_engine() is engine
        assert engine == Processes(3)
        assert engine.place == "3 processes"
    assert current_engine() == before


def test_options_jobs_and_cluster_together_are_refused():
    with pytest.raises(click.UsageError, match="give one of them"), Workers(2, "local:2").engine():
        pass
