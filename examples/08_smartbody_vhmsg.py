"""Between the Virtual Human Toolkit and a robot: `vrSpeak` is performed, and `vrAgentBML` tells how it goes."""

import re
import sys
from urllib.parse import unquote_plus

from kinesic.client import PORT, Client

try:
    import stomp  # from PyPI: stomp.py
except ImportError:
    stomp = None
SCOPE, HEAD = "/topic/DEFAULT_SCOPE", {"MESSAGE_PREFIX": "vrAgentBML"}


def serve(robot: Client, broker: int) -> None:
    """Passes messages on until one side is gone."""
    link, listener, asked = stomp.Connection([("127.0.0.1", broker)]), stomp.ConnectionListener(), {}

    def perform(frame: object) -> None:
        said = frame.body if "<" in frame.body else unquote_plus(frame.body)
        if found := re.match(r"vrSpeak (\S+ \S+ (\S+))\s+(<.*)", said, re.DOTALL):
            asked[found[2]] = found[1]
            robot.send(re.sub(r"<bml\b(?![^>]*\sid=)", f'<bml id="{found[2]}"', found[3], count=1))

    listener.on_message = perform
    link.set_listener("vrSpeak", listener), link.connect(wait=True)
    link.subscribe(SCOPE, id="scope")
    print(f"performs vrSpeak SPEAKER LISTENER ID <xml> of {SCOPE}", flush=True)
    while True:
        for name, point in re.findall(r'<blockProgress[^>]* id="(.*?):(start|end)"', robot.receive()):
            link.send(SCOPE, f"vrAgentBML {asked.get(name, name)} {point.replace('end', 'end complete')}", headers=HEAD)


if stomp is None or not (ports := list(map(int, sys.argv[1:]))):
    print(f"skipped: needs stomp.py, and two ports: of `kinesic serve` ({PORT}) and of the broker (61613)")
else:
    with Client(port=ports[0]) as robot:
        serve(robot, ports[1])
