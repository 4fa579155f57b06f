"""Where the corpus is, and utterances for tests."""

import os
from pathlib import Path

from kinesic.bml.block import Block, Speech
from kinesic.body.utterance import Utterance

CORPUS = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
SECONDS_PER_LETTER = 0.07


def documents() -> list[str]:
    """Documents with behaviours, relative to the corpus; none when there is no corpus."""
    folders = ("greta/bml", "greta/fml", "openbmlparser", "realizertester", "asap")
    return [str(path.relative_to(CORPUS)) for folder in folders for path in sorted((CORPUS / folder).rglob("*.xml"))]


def spoken(block: Block) -> dict[str, Utterance]:
    """Every speech of a block, said at an even pace."""
    return {
        behaviour.id: Utterance(
            SECONDS_PER_LETTER * len(behaviour.action.script.text),
            {mark.name: SECONDS_PER_LETTER * mark.position for mark in behaviour.action.script.marks},
        )
        for behaviour in block.behaviours
        if isinstance(behaviour.action, Speech)
    }
