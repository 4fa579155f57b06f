"""Captured gestures in place of those of the lexicon, for a text."""

import pytest

from kinesic.expressivity.lexicon.gesture_motion import pack_motion
from kinesic.session.documents import write_bml, write_fml
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

from ..expressivity.lexicon.captured_clips import motion, write_gesture

TEXT = "It is a very long way. (offers) Please take it."
FML = """<fml-apml>
<bml><speech id="s1"><text>There <sync id="tm1"/>is the door.</text></speech></bml>
<fml><deictic start="s1:tm1" end="s1:tm1+1" importance="0.9" target="door"/></fml>
</fml-apml>"""


@pytest.fixture
def setup(tmp_path):
    """Set up a captured offer and a captured wave, preferred to the lexicon's."""
    write_gesture(tmp_path, "my_offer", category="metaphoric", like="offer")
    write_gesture(tmp_path, "my_wave", category="emblem", like="wave")
    return set_up("upper22", lexicon=tmp_path, prefer="captured", targets={"door": (2.0, -0.3, 0.3)})


def test_captured_offer_replaces_that_of_the_lexicon_with_a_reason(setup):
    bml = write_bml(TEXT, setup)
    assert 'lexeme="my_offer"' in bml
    assert "captured my_offer in place of offer, from rest, CC0" in bml
    planned = plan(bml, setup)
    outcome = next(planned.keyframes.outcomes[b.id] for b in planned.timeline.block.behaviours if b.type == "gesture")
    assert outcome.kind == "realised"


def test_lexicon_is_preferred_by_default(setup, tmp_path):
    plain = set_up("upper22", lexicon=tmp_path, targets={"door": (2.0, -0.3, 0.3)})
    assert "my_offer" not in write_bml(TEXT, plain)


def test_emblems_stay_those_of_the_lexicon(setup):
    assert "my_wave" not in write_bml("(waves) Hello.", setup)


def test_captured_pointing_gesture_points_at_the_target_of_an_intention(setup, tmp_path):
    assert "<pointing" in write_fml(FML, setup)[0]
    straight = pack_motion(motion(turn=0.0))
    write_gesture(tmp_path, "my_point", category="deictic", like="this_index", data=straight)
    pointing = set_up("upper22", lexicon=tmp_path, prefer="captured", targets={"door": (2.0, -0.3, 0.3)})
    line = next(line for line in write_fml(FML, pointing)[0].splitlines() if "my_point" in line)
    assert line.strip().startswith("<gesture ")
    assert 'target="door"' in line
    planned = plan(FML, pointing)
    (behaviour,) = (each for each in planned.timeline.block.behaviours if each.type == "gesture")
    assert planned.keyframes.outcomes[behaviour.id].kind == "realised"
    aside = set_up("upper22", lexicon=tmp_path, prefer="captured", targets={"door": (-2.0, -0.3, 0.3)})
    assert "<pointing" in write_fml(FML, aside)[0]  # the clip would turn too far
