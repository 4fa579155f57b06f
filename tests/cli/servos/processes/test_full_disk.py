"""Performance and server if the disk becomes full during the motion.

A limit on the file size of the processes simulates the full disk.
"""

import json
import signal
import time
from resource import RLIMIT_FSIZE, prlimit

import pytest

from .conftest import RAISE_BML
from .test_signals import serve

pytestmark = [pytest.mark.realtime, pytest.mark.soak]


def test_performance_continues_on_a_full_disk_and_reports_the_lost_result(arms, perform):
    command = perform(3.0)
    command.wait(arms.is_raised)
    for process in (command.process.pid, command.supervisor()):
        prlimit(process, RLIMIT_FSIZE, (1000, 1000))
    assert command.end() == 2
    assert arms.is_home
    assert command.has_cleaned_up()
    out = command.folder / "out"
    lines = [line for line in command.output.splitlines() if "File too large" in line]
    assert len(lines) == 2, lines
    assert lines[0].endswith(f"{out / 'events.jsonl'}: File too large; events are lost")
    assert lines[1].endswith("kinesic: out/report.json: File too large")
    assert "Traceback" not in command.output
    assert "Exception" not in command.output
    assert "servos" not in json.loads((out / "report.json").read_text()), "the report of the twin is still complete"
    assert all(json.loads(line) for line in (out / "events.jsonl").read_text().splitlines())
    assert sorted(path.name for path in out.iterdir() if path.name.startswith(".")) == [".kinesic"]
    assert not (out / "servos.npz").exists()


def test_server_continues_on_a_full_disk_and_reports_lost_events(arms, run):
    command, client = serve(arms, run)
    with client:
        client.send(RAISE_BML.format(3.0, 4.0))
        command.wait(arms.is_raised)
        prlimit(command.supervisor(), RLIMIT_FSIZE, (0, 0))
        while 'id="b:end"' not in client.receive(30):
            pass
        time.sleep(0.2)
        command.process.send_signal(signal.SIGTERM)
        assert command.end() == 0
    assert "events.jsonl: File too large; events are lost" in command.output
    assert arms.is_home
    assert "Traceback" not in command.output
