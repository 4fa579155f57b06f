"""Independent servos on a pseudo-terminal, driven by the manufacturer's SDK."""

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from dynamixel_sdk import COMM_SUCCESS, PacketHandler, PortHandler

ROOT = Path(__file__).parents[2]
PATIENCE = 10.0  # [s] longest wait for the other process


@pytest.fixture
def port() -> Iterator[PortHandler]:
    """Open a port with two servos in another process."""
    command = [sys.executable, "-m", "manual_servo", "1:xm430_w210", "2:xc330_t288"]
    with subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdin
        assert process.stdout
        handler = PortHandler(process.stdout.readline().strip())
        assert handler.openPort()
        assert handler.setBaudRate(1_000_000)
        yield handler
        handler.closePort()
        process.stdin.close()
        assert process.wait(PATIENCE) == 0


@pytest.mark.realtime
def test_manufacturer_sdk_drives_independently_written_servos_on_a_pseudo_terminal(port: PortHandler):
    sdk = PacketHandler(2.0)
    until(lambda: sdk.ping(port, 1) == (1030, COMM_SUCCESS, 0))
    until(lambda: sdk.ping(port, 2) == (1220, COMM_SUCCESS, 0))
    until(lambda: sdk.write1ByteTxRx(port, 2, 64, 1) == (COMM_SUCCESS, 0))
    until(lambda: sdk.write4ByteTxRx(port, 2, 116, 2300) == (COMM_SUCCESS, 0))
    until(lambda: abs(sdk.read4ByteTxRx(port, 2, 132)[0] - 2300) <= 5)


def until(answered: Callable[[], bool]) -> None:
    """Repeat a query until it succeeds, because the SDK waits only 34 ms."""
    limit = time.monotonic() + PATIENCE
    while not answered():
        assert time.monotonic() < limit
