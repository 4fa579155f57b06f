"""Third-party programs on virtual Feetech and Protocol 1.0 servos behind a pseudo-terminal."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from dynamixel_sdk import COMM_SUCCESS, PacketHandler, PortHandler

from kinesic.hardware.virtual.pty import PtyPort, serve_wires
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

pytestmark = pytest.mark.realtime

IDS = (1, 2, 3)  # ids of the servos
REPLY_TIMEOUT = 0.5  # [s] time limit of the programs for a reply


@contextmanager
def served(folder: Path, model: str) -> Iterator[str]:
    """Serve three virtual servos in a thread.

    Yields the path of their port.
    """
    fittings = tuple(ServoFitting(servo, model=model, ticks=2000 + 100 * servo) for servo in IDS)
    _, buses = build_bus([Cable("body", fittings)])
    port, stopped = PtyPort(buses["body"], folder / "body"), threading.Event()
    port.exchange(0.0)
    thread = threading.Thread(target=serve_wires, args=([port], lambda: not stopped.is_set()))
    thread.start()
    try:
        yield str(folder / "body")
    finally:
        stopped.set()
        thread.join()


def test_dynamixel_sdk_drives_virtual_mx_servos_by_protocol_1(tmp_path: Path):
    with served(tmp_path, "mx28") as path:
        port, packets = PortHandler(path), PacketHandler(1.0)
        assert port.openPort()
        assert port.setBaudRate(1_000_000)
        try:
            number, result, error = packets.ping(port, 2)
            assert (number, result, error) == (29, COMM_SUCCESS, 0)
            assert packets.read2ByteTxRx(port, 2, 36) == (2200, COMM_SUCCESS, 0)
            assert packets.write2ByteTxRx(port, 2, 30, 2250) == (COMM_SUCCESS, 0)
            assert packets.read2ByteTxRx(port, 2, 30)[0] == 2250
        finally:
            port.closePort()


def test_rustypot_reads_and_moves_virtual_sts_servos(tmp_path: Path):
    rustypot = pytest.importorskip("rustypot", reason="rustypot is not installed")
    with served(tmp_path, "sts3215") as path:
        servos = rustypot.Sts3215PyController(path, 1_000_000, REPLY_TIMEOUT)
        before = servos.sync_read_present_position(list(IDS))
        assert len(before) == len(IDS)
        assert before[1] - before[0] == pytest.approx(before[2] - before[1], abs=1e-6)
        servos.sync_write_torque_enable(list(IDS), [True] * 3)
        assert servos.sync_read_torque_enable(list(IDS)) == [True] * 3


def test_vendor_sdk_of_feetech_reads_virtual_sts_servos(tmp_path: Path):
    sdk = pytest.importorskip("scservo_sdk", reason="feetech-servo-sdk is not installed")
    with served(tmp_path, "sts3215") as path:
        port, packets = sdk.PortHandler(path), sdk.PacketHandler(0)
        assert port.openPort()
        assert port.setBaudRate(1_000_000)
        try:
            number, result, error = packets.ping(port, 3)
            assert (number, result, error) == (777, sdk.COMM_SUCCESS, 0)
            assert packets.read2ByteTxRx(port, 3, 56)[:2] == (2300, sdk.COMM_SUCCESS)
            reader = sdk.GroupSyncRead(port, packets, 56, 15)
            for servo in IDS:
                assert reader.addParam(servo)
            assert reader.txRxPacket() == sdk.COMM_SUCCESS
            assert [reader.getData(servo, 56, 2) for servo in IDS] == [2100, 2200, 2300]
        finally:
            port.closePort()
