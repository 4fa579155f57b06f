"""HTML of plans and performances: verdict, replay and timeline."""

from base64 import b64encode
from io import BytesIO

from kinesic.controller.soundtrack import sound, write_wav
from kinesic.planning.plan import Plan
from kinesic.report.checks import grade
from kinesic.report.display.frame import MAX_DISPLAY_FRAMES, FrameContent, make_frame
from kinesic.report.display.tables import badge, folded_table, line
from kinesic.report.page import quantity
from kinesic.report.plots.score import MAX_ROWS, scores
from kinesic.report.replay import planned_replay_data, replay_data
from kinesic.report.run import Performance
from kinesic.report.verdict import rows_of, severity_rank, verdict


def plan_html(plan: Plan) -> str:
    """Return the HTML of a plan: summary, replay, timeline, notices."""
    notices = [(notice.id, notice.text) for notice in plan.notices]
    return line(str(plan)) + plan_frame(plan) + folded_table(_count(len(notices), "notice"), ("id", "text"), notices)


def plan_frame(plan: Plan) -> str:
    """Return an inline frame with the planned motion and its timeline."""
    content = FrameContent(
        title=str(plan),
        replay=planned_replay_data(plan, max_frames=MAX_DISPLAY_FRAMES),
        scores=scores(plan, plan.duration),
        rows=_rows(plan),
        zero=plan.trajectory.zero,
        voice=_voice(plan),
    )
    return make_frame(content)


def performance_html(run: Performance) -> str:
    """Return the HTML of a performance: verdict, replay, timeline, checks."""
    data, plan = run.data, run.plan
    _, text = verdict(data).split(": ", 1)
    frame = FrameContent(
        title=verdict(data),
        replay=replay_data(run, max_frames=MAX_DISPLAY_FRAMES),
        scores=scores(plan, run.duration),
        rows=_rows(plan),
        zero=plan.trajectory.zero,
        compared=True,
        voice=_voice(plan),
    )
    changed = [
        (str(row["id"]), str(row["name"]), str(row["outcome"]), str(row["why"]))
        for row in rows_of(data, "behaviours")
        if row["outcome"] != "realised"
    ]
    checks = [
        (
            str(row["name"]),
            str(row["status"]),
            _measure(row["value"], str(row["unit"])),
            f"{'at least' if row['at_least'] else 'at most'} {_measure(row['limit'], str(row['unit']))}",
            str(row["where"]),
        )
        for row in sorted(rows_of(data, "checks"), key=severity_rank)
    ]
    return (
        line(f" {text}", before=badge(grade(run.checks)))
        + make_frame(frame)
        + folded_table(
            f"{_count(len(changed), 'behaviour')} not as requested", ("id", "behaviour", "outcome", "why"), changed
        )
        + folded_table(_count(len(checks), "check"), ("check", "status", "value", "limit", "where"), checks)
    )


def _rows(plan: Plan) -> int:
    """Return the number of rows of a plan's timeline."""
    return min(len(plan.timeline.timed), MAX_ROWS + 1)


def _measure(value: object, unit: str) -> str:
    """Format a check value with its unit."""
    number, symbol = quantity(value if isinstance(value, bool | int | float | str) else None, unit)
    return f"{number} {symbol}".rstrip()


def _count(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _voice(plan: Plan) -> str | None:
    """Return the speech as a data URI, or None without audible speech."""
    speech = sound(plan)
    if speech is None:
        return None
    file = BytesIO()
    write_wav(speech, file)
    return f"data:audio/wav;base64,{b64encode(file.getvalue()).decode()}"
