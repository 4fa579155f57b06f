"""Warms a planner up, so that the first document finds everything at hand."""

from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import Scene, advance, begin, prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.serve.idling import plan_idle
from kinesic.serve.tracks import SoundAndFace, make_track

WARMING = (
    '<bml id="warming"><head id="nod" lexeme="NOD" start="0"/><gesture id="beat" lexeme="BEAT" start="0"/>'
    '<faceLexeme id="brows" lexeme="RAISE_BROWS" start="0"/><speech id="yes"><text>Yes.</text></speech></bml>'
)


def warm_up(setup: Setup, accompaniment: SoundAndFace) -> None:
    """Plans a block, and idle motion, that are never performed."""
    scene = begin(Scene.of(setup), prepare_block(read_request(Message(WARMING), setup), setup), 0.0)
    for running in scene.playing:
        make_track(running, accompaniment)
    advance(scene, 0.1)
    plan_idle(setup, 0)
