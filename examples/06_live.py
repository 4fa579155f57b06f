"""A client of `kinesic serve`: sends a block, follows its feedback, and asks how it goes."""

import sys

from kinesic.client import PORT, Client

BML = """
<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}" composition="{}">
  <head id="nod" lexeme="NOD" start="0"/>
  <gesture id="beat" lexeme="BEAT" stroke="nod:stroke"/>
</bml>
"""

try:
    with Client(port=int(sys.argv[1]) if len(sys.argv) > 1 else PORT) as robot:
        robot.send(BML.format("first", "MERGE"))
        for message in robot.perform(BML.format("second", "APPEND")):  # begins when the first has ended
            print(message)
        robot.do("status")
        print(robot.receive(timeout=1.0))
except ConnectionRefusedError:
    print("skipped: nobody listens here; start `kinesic serve` first")
