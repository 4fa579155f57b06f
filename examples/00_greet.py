"""Perform a greeting in the twin and print the checks."""

import kinesic

BML = """
<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
  <speech id="s"><text>Good <sync id="m"/>morning!</text></speech>
  <gesture id="wave" lexeme="greet_wave" mode="RIGHT_HAND" stroke="s:m+0.3"/>
  <head id="nod" lexeme="NOD" stroke="s:m"/>
</bml>
"""

run = kinesic.perform(BML)
print(run)
for check in run.checks:
    print(f"{check.status:5} {check.name:22} {check.value:10.4g} {check.unit:6} {check.where}")
