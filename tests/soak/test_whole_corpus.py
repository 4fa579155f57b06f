"""Soak test: each document of the corpus is performed or refused with location."""

import os
from pathlib import Path

import pytest

from kinesic.report.batch import documents, validate_documents
from kinesic.session.setup import set_up
from kinesic.tasks.engine import current_engine

CORPUS = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))

pytestmark = [
    pytest.mark.soak,
    pytest.mark.skipif(not CORPUS.exists(), reason=f"no corpus of BML documents at {CORPUS} (KINESIC_CORPUS)"),
]


@pytest.mark.parametrize(
    "folder", ["greta/bml", "greta/fml", "greta/malformed", "openbmlparser", "realizertester", "asap"]
)
def test_corpus_documents_are_performed_or_refused_with_a_location(folder):
    files = documents((CORPUS / folder,))
    verdicts = list(validate_documents(files, set_up, engine=current_engine()))
    assert len(verdicts) == len(files)
    assert [verdict.file for verdict in verdicts if verdict.exit] == []
    for verdict in verdicts:
        assert verdict.outcome == "performed" or verdict.error.startswith(f"{verdict.file}:")


def test_at_least_95_percent_of_greta_gestures_heads_and_gazes_are_performed():
    verdicts = validate_documents(documents((CORPUS / "greta" / "bml",)), set_up, engine=current_engine())
    outcomes = [
        o for verdict in verdicts for kind, o in verdict.behaviours if kind in ("gesture", "head", "gaze", "gazeShift")
    ]
    assert len([outcome for outcome in outcomes if outcome != "dropped"]) >= 0.95 * len(outcomes)
