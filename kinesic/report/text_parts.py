"""Summary of a long text that is performed part by part."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path

from kinesic.bml.actions import Speech
from kinesic.files.output_file import write_text
from kinesic.files.unicode_text import escape_surrogates
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.setup import Setup
from kinesic.report.batch import DocumentVerdict, judge_performance
from kinesic.report.batch_totals import counts, worst_checks
from kinesic.report.checks import grade
from kinesic.report.report import Json
from kinesic.version import __version__

PARTS_FILE = "parts.json"  # file name of the summary in the output folder


@dataclass(frozen=True, eq=False)
class PerformedPart:
    """Result of one part of a text, without its motion."""

    words: int  # number of spoken words
    duration: float  # [s] duration of the performance
    warnings: int  # number of warnings in the report
    verdict: DocumentVerdict  # checks and behaviours; its file is the folder of the part

    @classmethod
    def of(cls, name: str, performance: DryRun) -> "PerformedPart":
        """Keep the figures of a performed part.

        Args:
            name: of its folder.
            performance: in the twin.
        """
        plan = performance.plan
        actions = (behaviour.action for behaviour in plan.timeline.block.behaviours)
        words = sum(len(action.script.text.split()) for action in actions if isinstance(action, Speech))
        return cls(words, performance.duration, len(plan.notices), judge_performance(name, performance))


def write_parts(
    folder: Path, done: Sequence[PerformedPart], setup: Setup, *, source: str, count: int
) -> dict[str, Json]:
    """Write the summary of all performed parts.

    Args:
        folder: output folder with a folder for each part.
        done: parts in their order.
        setup: robot, style and seed.
        source: name of the text.
        count: number of all parts.

    Returns:
        The written summary.
    """
    verdicts = [part.verdict for part in done]
    grades = [grade(verdict.checks) for verdict in verdicts]
    starts = accumulate((part.duration for part in done), initial=0.0)
    data: dict[str, Json] = {
        "kinesic": __version__,
        "input": escape_surrogates(source),
        "robot": setup.robot.name,
        "style": setup.style.name,
        "seed": setup.idling.seed,
        "ok": "fail" not in grades,
        "complete": len(done) == count,
        "count": count,
        "words": sum(part.words for part in done),
        "duration_s": sum(part.duration for part in done),
        "parts": [
            {
                "folder": part.verdict.file,
                "start_s": start,
                "duration_s": part.duration,
                "words": part.words,
                "grade": result,
                "warnings": part.warnings,
            }
            for part, start, result in zip(done, starts, grades, strict=False)
        ],
        "totals": {**counts(verdicts), "checks": worst_checks(verdicts)},
    }
    write_text(folder / PARTS_FILE, json.dumps(data, indent=1), force=True)
    return data
