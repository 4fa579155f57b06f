"""A seeded choice of documents that others wrote, planned; the folder is not part of the project."""

import os
import random
from pathlib import Path

from kinesic.bml.block import BmlError
from kinesic.controller.perform import plan
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.report.batch import documents

SEED = 50
LONGEST = 60.0  # [s] of a block


def folder() -> Path | None:
    """KINESIC_CORPUS, or `shared/corpus` beside the project; None where there is none."""
    path = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
    return path if path.is_dir() else None


def blocks(where: Path, known: Setup, count: int) -> tuple[Plan, ...]:
    """The first so many documents, in a seeded order, that perform a stroke.

    Args:
        where: the folder.
        known: what planning needs.
        count: of documents.
    """
    files = documents((where,))
    random.Random(SEED).shuffle(files)
    chosen: list[Plan] = []
    for file in files:
        try:
            found = plan(file.read_bytes(), known, source=str(file))
        except BmlError:
            continue
        if found.duration <= LONGEST and any(sync.is_stroke for sync in found.syncs):
            chosen.append(found)
        if len(chosen) == count:
            break
    return tuple(chosen)
