"""HTML of gestures: their properties, and a replay of the gesture alone."""

from dataclasses import replace
from functools import cache
from xml.sax.saxutils import quoteattr

from kinesic.expressivity.lexicon.entries import ParsedEntry
from kinesic.expressivity.lexicon.form import GestureForm, Match
from kinesic.expressivity.lexicon.senses import Sense
from kinesic.planning.setup import Setup
from kinesic.report.display.plan import plan_frame
from kinesic.report.display.tables import line
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

STROKE_TIME = 1.2  # [s] requested stroke time of a displayed gesture
SHAPELESS_ROBOT = "upper22"  # robot that shows gestures without hand shapes
FINGERED_ROBOT = "upper36"  # robot that shows gestures with hand shapes


def match_html(match: Match) -> str:
    """Return the HTML of a found gesture, and of its substitution note."""
    return (line(match.substitute) if match.substitute else "") + gesture_html(match.form)


def gesture_html(form: GestureForm) -> str:
    """Return the HTML of a gesture: summary, and replay without other behaviours."""
    setup = _setup(FINGERED_ROBOT if form.shapes else SHAPELESS_ROBOT)
    entry = ParsedEntry(form, Sense((form.id,), form.category))
    lexicon = replace(setup.lexicon, entries=(entry, *setup.lexicon.entries)).as_written
    lexeme = quoteattr(f"{form.category}={form.id}")
    document = f'<bml id="alone"><gesture id="gesture" lexeme={lexeme} stroke="{STROKE_TIME:g}"/></bml>'
    planned = plan(document, replace(setup, lexicon=lexicon), source=f"<{form.id}>")
    outcome = planned.keyframes.outcomes["gesture"]
    why = f"{planned.setup.robot.name}: {outcome.kind}, {outcome.why}" if outcome.why else ""
    return line(str(form)) + (line(why) if why else "") + plan_frame(planned)


@cache
def _setup(robot: str) -> Setup:
    """Return a robot's setup without idle motion and gesture variation."""
    return set_up(robot, idle=0.0, variation=0.0)
