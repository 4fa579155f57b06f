"""A disk that fills up while arms are raised. The size that files of a process may have stands for the disk."""

import json
import signal
import time
from resource import RLIMIT_FSIZE, prlimit

import pytest

from .conftest import RAISE
from .test_signals import serve

pytestmark = [pytest.mark.realtime, pytest.mark.soak]


def test_a_performance_goes_on_to_its_end_and_one_line_tells_which_result_is_lost(arms, perform):
    command = perform(3.0)
    command.wait(arms.raised)
    for process in (command.process.pid, command.supervisor()):
        prlimit(process, RLIMIT_FSIZE, (1000, 1000))
    assert command.end() == 2
    assert arms.home
    assert command.leaves_nothing()
    out = command.folder / "out"
    lines = [line for line in command.said.splitlines() if "File too large" in line]
    assert len(lines) == 2, lines
    assert lines[0].endswith(f"{out / 'events.jsonl'}: File too large; events are lost")
    assert lines[1].endswith("kinesic: out/report.json: File too large")
    assert "Traceback" not in command.said
    assert "Exception" not in command.said
    assert "servos" not in json.loads((out / "report.json").read_text()), "the twin's report stays whole"
    assert all(json.loads(line) for line in (out / "events.jsonl").read_text().splitlines())
    assert sorted(path.name for path in out.iterdir() if path.name.startswith(".")) == [".kinesic"]
    assert not (out / "servos.npz").exists()


def test_a_server_goes_on_and_tells_that_events_are_lost(arms, run):
    command, client = serve(arms, run)
    with client:
        client.send(RAISE.format(3.0, 4.0))
        command.wait(arms.raised)
        prlimit(command.supervisor(), RLIMIT_FSIZE, (0, 0))
        while 'id="b:end"' not in client.receive(30):
            pass
        time.sleep(0.2)
        command.process.send_signal(signal.SIGTERM)
        assert command.end() == 0
    assert "events.jsonl: File too large; events are lost" in command.said
    assert arms.home
    assert "Traceback" not in command.said
