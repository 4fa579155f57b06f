"""Connect the Virtual Human Toolkit to a robot: vrSpeak in, vrAgentBML out."""

import re
import sys
from urllib.parse import unquote_plus

from kinesic.client import DEFAULT_PORT, Client

try:
    import stomp  # from PyPI: stomp.py
except ImportError:
    stomp = None
SCOPE_TOPIC = "/topic/DEFAULT_SCOPE"


def serve(robot: Client, broker: int) -> None:
    """Forward messages in both directions until a connection closes."""
    link, listener, requests = stomp.Connection([("127.0.0.1", broker)]), stomp.ConnectionListener(), {}

    def perform(frame: object) -> None:
        message = frame.body if "<" in frame.body else unquote_plus(frame.body)
        if match := re.match(r"vrSpeak (\S+ \S+ (\S+))\s+(<.*)", message, re.DOTALL):
            requests[match[2]] = match[1]
            robot.send(re.sub(r"<bml\b(?![^>]*\sid=)", f'<bml id="{match[2]}"', match[3], count=1))

    listener.on_message = perform
    link.set_listener("vrSpeak", listener), link.connect(wait=True), link.subscribe(SCOPE_TOPIC, id="scope")
    print(f"performs vrSpeak SPEAKER LISTENER ID <xml> of {SCOPE_TOPIC}", flush=True)
    while True:
        for name, point in re.findall(r'<blockProgress[^>]* id="(.*?):(start|end)"', robot.receive()):
            status = f"vrAgentBML {requests.get(name, name)} {point.replace('end', 'end complete')}"
            link.send(SCOPE_TOPIC, status, headers={"MESSAGE_PREFIX": "vrAgentBML"})


if stomp is None or not (ports := list(map(int, sys.argv[1:]))):
    print(f"skipped: needs stomp.py, and the ports of `kinesic serve` ({DEFAULT_PORT}) and of the broker (61613)")
else:
    with Client(port=ports[0]) as robot:
        serve(robot, ports[1])
