"""Performs a greeting in the twin and prints the verdicts."""

from kinesic.controller.perform import perform
from kinesic.report.checks import checks

BML = """
<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
  <speech id="s"><text>Good <sync id="m"/>morning!</text></speech>
  <gesture id="wave" lexeme="greet_wave" mode="RIGHT_HAND" stroke="s:m+0.3"/>
  <head id="nod" lexeme="NOD" stroke="s:m"/>
</bml>
"""

performance = perform(BML)
for check in checks(performance):
    print(f"{check.status:5} {check.name:22} {check.value:10.4g} {check.unit:6} {check.where}")
