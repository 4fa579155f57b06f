"""Captured gestures in place of those of the lexicon, for a text."""

from dataclasses import replace

import pytest

from kinesic.capture.clip_substitution import graph_of
from kinesic.capture.graph_search import REPETITION_TIME
from kinesic.expressivity.lexicon.gesture_motion import pack_motion
from kinesic.intent.reading.language import load_language
from kinesic.intent.talk import Talk, add_words, next_part
from kinesic.serve.tracks import NO_ACCOMPANIMENT
from kinesic.serve.warm_up import warm_up
from kinesic.session.documents import find_revision, intention_sets, write_bml, write_fml, write_text
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
    """Return a setup that prefers a captured offer and wave to lexicon gestures."""
    write_gesture(tmp_path, "my_offer", category="metaphoric", like="offer")
    write_gesture(tmp_path, "my_wave", category="emblem", like="wave")
    return set_up("upper22", lexicon=tmp_path, prefer="captured", targets={"door": (2.0, -0.3, 0.3)})


def test_captured_offer_gesture_replaces_the_offer_of_the_lexicon_with_a_reason(setup):
    bml = write_bml(TEXT, setup)
    assert 'lexeme="my_offer"' in bml
    assert "captured my_offer in place of offer, from rest, CC0" in bml
    planned = plan(bml, setup)
    outcome = next(planned.keyframes.outcomes[b.id] for b in planned.timeline.block.behaviours if b.type == "gesture")
    assert outcome.kind == "realised"


def test_texts_get_no_captured_gestures_by_default(setup, tmp_path):
    plain = set_up("upper22", lexicon=tmp_path, targets={"door": (2.0, -0.3, 0.3)})
    assert "my_offer" not in write_bml(TEXT, plain)


def test_streamed_phrases_use_captured_gestures_but_no_clip_twice_within_20_s(setup):
    talk, shown = add_words(Talk(), "(offers) Please take it. (offers) Please take it, too. ", ends=True), []
    sets, english = intention_sets(setup), load_language("en")
    while part := next_part(talk, setup.lexicon, setup.style, english, sets, revise=find_revision(setup)):
        talk, shown = part.talk, [*shown, *(each.lexeme for each in part.behaviours if each.channel == "gesture")]
    assert shown.count("my_offer") == 1
    assert [clip.form for clip in talk.memory.clips] == ["my_offer"]


def test_captured_clip_is_not_repeated_in_the_next_text_within_20_s_of_speech(setup):
    first = write_text(TEXT, setup)
    assert "my_offer" in first.bml
    assert "my_offer" not in write_text(TEXT, setup, first.memory).bml
    later = replace(first.memory, seconds=first.memory.seconds + REPETITION_TIME)
    assert "my_offer" in write_text(TEXT, setup, later).bml


def test_warm_up_of_a_live_planner_builds_the_motion_graph(setup):
    warm_up(setup, NO_ACCOMPANIMENT)
    before = graph_of.cache_info()
    graph_of(setup.lexicon.captured)
    assert graph_of.cache_info().hits == before.hits + 1


def test_captured_gesture_never_replaces_an_emblem_of_the_lexicon(setup):
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
