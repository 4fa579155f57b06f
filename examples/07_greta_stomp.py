"""Between Greta's planner and a robot: BML on its ActiveMQ topic is performed, feedback goes back by another."""

import sys

from kinesic.client import PORT, Client

try:
    import stomp  # from PyPI: stomp.py
except ImportError:
    stomp = None

BML, FEEDBACK = "/topic/greta.BML", "/topic/greta.output.feedback.BML"


def serve(robot: Client, broker: int) -> None:
    """Passes messages on in both directions until one side is gone."""
    planner = stomp.Connection([("127.0.0.1", broker)])
    listener = stomp.ConnectionListener()
    listener.on_message = lambda frame: robot.send(frame.body)
    planner.set_listener("bml", listener)
    planner.connect(wait=True)
    planner.subscribe(BML, id="bml")
    print(f"performs what comes to {BML}", flush=True)
    while True:
        planner.send(FEEDBACK, robot.receive())


if stomp is None or not (ports := list(map(int, sys.argv[1:]))):
    print(f"skipped: needs stomp.py, and two ports: of `kinesic serve` ({PORT}) and of the broker (61613)")
else:
    with Client(port=ports[0]) as robot:
        serve(robot, ports[1])
