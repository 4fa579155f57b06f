"""Documents of other authors: a seeded sample of each corpus folder."""

import os
import random
from pathlib import Path

import pytest

from kinesic.report.batch import documents, judge_document
from kinesic.session.setup import set_up

CORPUS = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
SAMPLE_SIZES = {"greta/bml": 4, "greta/fml": 3, "openbmlparser": 4, "realizertester": 5, "asap": 3}

pytestmark = pytest.mark.skipif(not CORPUS.exists(), reason=f"no corpus of BML documents at {CORPUS} (KINESIC_CORPUS)")


@pytest.fixture(scope="module")
def known():
    return set_up()


def sample() -> list[Path]:
    chosen = random.Random(24)
    return [
        path
        for folder, count in SAMPLE_SIZES.items()
        if (CORPUS / folder).exists()
        for path in chosen.sample(documents((CORPUS / folder,)), count)
    ]


@pytest.mark.parametrize("path", sample(), ids=lambda path: path.stem)
def test_corpus_document_is_performed_within_limits_or_refused_with_its_location(path, known):
    verdict, data = judge_document(path, known)
    assert verdict.exit == 0
    if verdict.outcome == "refused":
        assert verdict.error.startswith(f"{path}:")
        return
    assert data["limits"]["violations"] == 0
    assert data["collision"]["penetrations"] == 0
    dropped = [entry for entry in data["behaviours"] if entry["outcome"] == "dropped"]
    assert all(entry["why"] for entry in dropped)
    assert sum(map(verdict.count, ("realised", "partly", "substituted"))) > 0 or not verdict.behaviours


@pytest.mark.parametrize("path", documents((CORPUS / "greta" / "malformed",)) if CORPUS.exists() else [])
def test_malformed_documents_are_refused_with_line_and_column(path, known):
    verdict, _ = judge_document(path, known)
    assert verdict.outcome == "refused"
    line, column = verdict.error.removeprefix(f"{path}:").split(":")[:2]
    assert int(line) > 1
    assert int(column) >= 1
