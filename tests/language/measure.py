"""Measure the wording of the project against its limits."""

import tomllib
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from .code import Finding, read_findings
from .docs import read_sentences
from .rules import Limits

TREE_ROOT = Path(__file__).resolve().parent.parent.parent
ALLOWED_FILE = Path(__file__).with_name("allowed.toml")


@dataclass(frozen=True, eq=False)
class Metric:
    """Number of texts of one kind, and of those that break its rule."""

    kind: str
    count: int
    limit: float  # largest fraction of offenders
    offenders: Sequence[Finding]

    @property
    def fraction(self) -> float:
        """Offenders per text."""
        return len(self.offenders) / max(self.count, 1)

    @property
    def is_met(self) -> bool:
        """Whether the fraction is within the limit."""
        return self.fraction <= self.limit


def measure(root: Path = TREE_ROOT, limits: Limits = Limits()) -> list[Metric]:  # noqa: B008 - frozen
    """Measure all Python files of the package and all pages of docs."""
    sources = sorted((root / "kinesic").rglob("*.py"))
    pages = [*root.glob("*.md"), *(root / "docs").rglob("*.md"), *(root / "skills").rglob("*.md")]
    pages = sorted(page for page in pages if page.name != "CHANGELOG.md")  # whose items are one line each
    findings = [finding for path in sources for finding in read_findings(path, str(path.relative_to(root)))]
    findings += [finding for page in pages for finding in read_sentences(page, str(page.relative_to(root)))]
    findings += find_shared_names([finding for finding in findings if finding.kind == "public names"])
    counts = Counter(finding.kind for finding in findings)
    allowed = read_allowed()
    return [
        _count(kind, limit, [finding for finding in findings if finding.kind == kind], allowed)
        for kind, limit in (
            ("first lines", limits.first_lines),
            ("old words", limits.old_words),
            ("constants", limits.constants),
            ("long sentences", limits.long_sentences),
            ("long signatures", limits.long_signatures / max(counts["long signatures"], 1)),
            ("shared names", limits.shared_names / max(counts["shared names"], 1)),
        )
    ]


def find_shared_names(public_names: Sequence[Finding]) -> list[Finding]:
    """Return each public name once, as an offender if several modules define it."""
    places: dict[str, list[str]] = defaultdict(list)
    for finding in public_names:
        places[finding.text].append(finding.place)
    return [
        Finding("shared names", ", ".join(found), name, len({place.split(":")[0] for place in found}) > 1)
        for name, found in places.items()
    ]


def read_allowed(file: Path = ALLOWED_FILE) -> dict[tuple[str, str], str]:
    """Return the reason of each allowed text, by its kind and words."""
    entries = tomllib.loads(file.read_text(encoding="utf-8"))["allowed"]
    return {(entry["kind"], entry["text"]): entry["reason"] for entry in entries}


def _count(kind: str, limit: float, findings: Sequence[Finding], allowed: dict[tuple[str, str], str]) -> Metric:
    offenders = [item for item in findings if item.is_offender and (kind, item.text) not in allowed]
    return Metric(kind, len(findings), limit, offenders)
