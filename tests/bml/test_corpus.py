"""Documents of other realizers: each is performed, or refused with its place, and nothing else happens."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from kinesic.bml.block import Block, BmlError
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance

CORPUS = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
FOLDERS = ("greta/bml", "greta/fml", "greta/malformed", "openbmlparser", "realizertester", "asap")
FILES = sorted(path for folder in FOLDERS for path in (CORPUS / folder).rglob("*.xml"))
REFUSED = {  # and why
    "B0.xml": "duplicate attribute",
    "test_bml_gaze_attributes.xml": "mismatched tag",
    "testinvalidxml.xml": "mismatched tag",
    "testspeech_unknownbehavior.xml": "no behaviour 'unknownbeh'",
}
DROPPED = {  # document -> behaviours, all of them impossible as written, or tied to blocks that are not there
    "BML-FierteExpPrecendentes_FrdBigDecr.xml": 1,
    "testnod_invalidtime.xml": 1,
    "testspeech_invalidtime.xml": 1,
    "testspeech_invalidtimesync2.xml": 1,
    "testspeech_unknownsync.xml": 1,
    "speech_retime.xml": 1,
    "volumechange.xml": 1,
}
if not FILES:
    pytest.skip(f"no corpus at {CORPUS}", allow_module_level=True)


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(CORPUS)))
def test_document(path: Path, spoken: Callable[[Block], dict[str, Utterance]]) -> None:
    reason = REFUSED.get(path.name)
    if reason is not None:
        with pytest.raises(BmlError, match=rf"^{path.name}:\d+:\d+: .*{reason}.*; "):
            parse(path.read_bytes(), source=path.name)
        return
    block = parse(path.read_bytes(), source=path.name)
    timeline = schedule(block, spoken(block), {})
    assert len(timeline.timed) + len(timeline.dropped) == len(block.behaviours)
    for timed in timeline.timed:
        times = list(timed.times.values())
        assert times == sorted(times)
    if path.name != "testspeechinterrupt.xml":  # one of several of that name refers to another block
        assert len(timeline.dropped) == DROPPED.get(path.name, 0)
