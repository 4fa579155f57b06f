"""Stand-in for the daemon of a Reachy Mini, written from its public interface; it imports nothing of kinesic."""

import base64
import hashlib
import json
import math
import struct
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

POSE_KEYS = {"x", "y", "z", "roll", "pitch", "yaw"}
TARGET_KEYS = {"target_head_pose", "target_antennas", "target_body_yaw", "timestamp"}
HANDSHAKE_KEY = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"  # constant of RFC 6455


def find_fault(target: object) -> str | None:
    """Return why the daemon refuses a target, or None."""
    if not isinstance(target, dict) or not target.keys() <= TARGET_KEYS:
        return f"unknown keys: {target}"
    pose, antennas, body = (target.get(key) for key in ("target_head_pose", "target_antennas", "target_body_yaw"))
    if not isinstance(pose, dict) or not pose.keys() <= POSE_KEYS or not isinstance(antennas, list):
        return f"not a pose with antennas: {target}"
    values = [*pose.values(), *antennas, body]
    if len(antennas) != 2 or not all(isinstance(value, float) and math.isfinite(value) for value in values):
        return f"not finite: {target}"
    degrees = {key: math.degrees(pose.get(key, 0.0)) for key in ("roll", "pitch", "yaw")}
    yaw = math.degrees(body)
    limits = {"roll": 40, "pitch": 40, "yaw": 180}
    beyond = [key for key, limit in limits.items() if abs(degrees[key]) > limit]
    if beyond or abs(yaw) > 160 or abs(degrees["yaw"] - yaw) > 65 or max(map(abs, antennas)) > math.pi:
        return f"beyond the limits: {degrees}, body {yaw}, antennas {antennas}"
    if any(abs(pose[key]) > 0.02 for key in "xyz"):
        return f"beyond the reach of the platform: {pose}"
    return None


class Daemon(ThreadingHTTPServer):
    """Daemon on a free local port that records requests and targets."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.requests: list[tuple[str, object]] = []
        self.targets: list[dict] = []
        self.faults: list[str] = []
        self.refuses_all = False
        self.hangs_up = False  # whether the daemon ends connections at the first target

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.server_address[1]}"

    def judge(self, text: str) -> str | None:
        """Record a target, and return why it is refused, or None."""
        target = json.loads(text)
        fault = "motors are off" if self.refuses_all else find_fault(target)
        if fault is None:
            self.targets.append(target)
        else:
            self.faults.append(fault)
        return fault


class _Handler(BaseHTTPRequestHandler):
    server: Daemon
    protocol_version = "HTTP/1.1"

    def log_message(self, *_: object) -> None:
        """Print nothing."""

    def do_POST(self) -> None:
        content = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.server.requests.append((self.path, content))
        known = self.path in ("/api/move/goto", "/api/motors/set_mode/enabled")
        body = json.dumps({"status": "ok"} if known else {"detail": "Not Found"}).encode()
        self.send_response(200 if known else 404)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_GET(self) -> None:
        if self.path != "/api/move/ws/set_target" or "Sec-WebSocket-Key" not in self.headers:
            self.send_error(404)
            return
        key = self.headers["Sec-WebSocket-Key"] + HANDSHAKE_KEY
        self.send_response(101)
        self.send_header("Upgrade", "websocket")
        self.send_header("Connection", "Upgrade")
        self.send_header("Sec-WebSocket-Accept", base64.b64encode(hashlib.sha1(key.encode()).digest()).decode())
        self.end_headers()
        while (frame := self._read_frame()) is not None and not self.server.hangs_up:
            fault = self.server.judge(frame)
            if fault is not None:
                self._send_text(json.dumps({"status": "error", "detail": fault}))
        self.close_connection = True

    def _read_frame(self) -> str | None:
        """Return the text of the next frame, or None after a closing frame."""
        head = self.rfile.read(2)
        if len(head) < 2 or head[0] & 0x0F == 8:
            self.wfile.write(b"\x88\x00")
            return None
        size = head[1] & 0x7F
        if size == 126:
            (size,) = struct.unpack(">H", self.rfile.read(2))
        mask = self.rfile.read(4)
        return bytes(byte ^ mask[k % 4] for k, byte in enumerate(self.rfile.read(size))).decode()

    def _send_text(self, text: str) -> None:
        data = text.encode()
        size = bytes([len(data)]) if len(data) < 126 else b"\x7e" + struct.pack(">H", len(data))
        self.wfile.write(b"\x81" + size + data)


@contextmanager
def running_daemon() -> Iterator[Daemon]:
    """Run a daemon until the end of the context."""
    daemon = Daemon()
    thread = threading.Thread(target=daemon.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
    thread.start()
    try:
        yield daemon
    finally:
        daemon.shutdown()
        daemon.server_close()
        thread.join()
