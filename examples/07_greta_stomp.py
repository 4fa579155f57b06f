"""Connect Greta's planner to a robot over ActiveMQ: BML in, feedback out."""

import sys

from kinesic.client import DEFAULT_PORT, Client

try:
    import stomp  # from PyPI: stomp.py
except ImportError:
    stomp = None

BML_TOPIC = "/topic/greta.BML"
FEEDBACK_TOPIC = "/topic/greta.output.feedback.BML"


def serve(robot: Client, broker: int) -> None:
    """Forward messages in both directions until a connection closes."""
    planner = stomp.Connection([("127.0.0.1", broker)])
    listener = stomp.ConnectionListener()
    listener.on_message = lambda frame: robot.send(frame.body)
    planner.set_listener("bml", listener)
    planner.connect(wait=True)
    planner.subscribe(BML_TOPIC, id="bml")
    print(f"performs messages of {BML_TOPIC}", flush=True)
    while True:
        planner.send(FEEDBACK_TOPIC, robot.receive())


if stomp is None or not (ports := list(map(int, sys.argv[1:]))):
    print(f"skipped: needs stomp.py, and the ports of `kinesic serve` ({DEFAULT_PORT}) and of the broker (61613)")
else:
    with Client(port=ports[0]) as robot:
        serve(robot, ports[1])
