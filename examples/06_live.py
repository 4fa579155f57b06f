"""Send BML blocks to `kinesic serve`, and print feedback and status."""

import sys

from kinesic.client import DEFAULT_PORT, Client

BML = """
<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}" composition="{}">
  <head id="nod" lexeme="NOD" start="0"/>
  <gesture id="beat" lexeme="BEAT" stroke="nod:stroke"/>
</bml>
"""

try:
    with Client(port=int(sys.argv[1]) if len(sys.argv) > 1 else DEFAULT_PORT) as robot:
        robot.send(BML.format("first", "MERGE"))
        for message in robot.perform(BML.format("second", "APPEND")):  # starts when the first block has ended
            print(message)
        robot.do("status")
        print(robot.receive(timeout=1.0))
except ConnectionRefusedError:
    print("skipped: no server listens here; start `kinesic serve` first")
