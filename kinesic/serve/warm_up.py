"""Warms a planner up, so that the first document finds everything at hand."""

from dataclasses import replace

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import Scene, advance, begin, prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.serve.idling import plan_idle
from kinesic.serve.tracks import SoundAndFace, make_track

WARMING = (
    '<bml id="warming"><head id="nod" lexeme="NOD" start="0"/><gesture id="beat" lexeme="BEAT" start="0"/>'
    '<faceLexeme id="brows" lexeme="RAISE_BROWS" start="0"/><speech id="yes"><text>Yes.</text></speech></bml>'
)
UNKNOWN = "warming"  # means no gesture


def warm_up(setup: Setup, accompaniment: SoundAndFace) -> None:
    """Plans a block, and idle motion, that are never performed."""
    setup.lexicon.find(UNKNOWN)  # which has its table of names made
    known = replace(setup, lexicon=Lexicon.load())  # gestures of users may be of any kind
    scene = begin(Scene.of(known), prepare_block(read_request(Message(WARMING), known), known), 0.0)
    for running in scene.playing:
        make_track(running, accompaniment)
    advance(scene, 0.1)
    plan_idle(known, 0)
