"""Warm-up of a planner for fast planning of the first document."""

from dataclasses import replace

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import Scene, advance, begin, prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.serve.idling import plan_idle
from kinesic.serve.messages import Words
from kinesic.serve.talks import Talks
from kinesic.serve.tracks import SoundAndFace, make_track
from kinesic.session.documents import prepare_revision

WARM_UP_DOCUMENT = (
    '<bml id="warming"><head id="nod" lexeme="NOD" start="0"/><gesture id="beat" lexeme="BEAT" start="0"/>'
    '<faceLexeme id="brows" lexeme="RAISE_BROWS" start="0"/><speech id="yes"><text>Yes.</text></speech></bml>'
)
WARM_UP_TEXT = "No, I never saw three boxes there, but it was really big! "  # short text with intents of several kinds
UNKNOWN_LEXEME = "warming"  # gesture name that does not exist; its search builds the table of names


def warm_up(setup: Setup, accompaniment: SoundAndFace) -> None:
    """Plan a block, a streamed phrase and idle motion without performing them."""
    setup.lexicon.find(UNKNOWN_LEXEME)  # builds the table of names
    warm_setup = replace(setup, lexicon=Lexicon.load())  # user gestures may lack the lexemes of the document
    scene = begin(
        Scene.of(warm_setup), prepare_block(read_request(Message(WARM_UP_DOCUMENT), warm_setup), warm_setup), 0.0
    )
    for running in scene.playing:
        make_track(running, accompaniment)
    advance(scene, 0.1)
    prepare_revision(setup)
    talks = Talks()
    talks.take(Words(WARM_UP_TEXT, 0, ends=True), 0.0)
    phrase = talks.next_phrase(Scene.of(setup), 0.0)  # builds the tables of its own lexicon
    assert phrase is not None  # the text is complete
    prepare_block(read_request(Message(phrase.bml), warm_setup), warm_setup)
    plan_idle(warm_setup, 0)
