"""The page of the report, on a performance built by hand."""

import base64
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from kinesic.bml.block import Behaviour, Block, Gesture, Head, Notice, NoticeType, Place, Speech, Timed, Timeline
from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Clearance
from kinesic.body.measurements import Measurements
from kinesic.body.robot import SIDES, Robot
from kinesic.body.utterance import Mark, Script, Utterance
from kinesic.controller.condition import Conditioned
from kinesic.controller.facts import Facts
from kinesic.controller.page import number, verdict, write_page
from kinesic.controller.performance import Performance
from kinesic.controller.plan import Plan
from kinesic.controller.plots import POINTS, apart, shortened, thinned
from kinesic.controller.plots_joints import still
from kinesic.controller.postures import Posture, Postures
from kinesic.controller.report import Json, report
from kinesic.controller.syncs import SyncTime
from kinesic.controller.trajectory import Manner, spline
from kinesic.expressivity.keyframes import KeyFrames, Outcome
from kinesic.expressivity.lexicon import Lexicon
from kinesic.expressivity.style import Style
from kinesic.speech.durations import DurationModel

HOSTILE = '<script>alert("$x_1^$")</script>&--> \u6b22\u8fce'
MOVED = ("r_shoulder_flexion", "r_elbow_flexion", "l_shoulder_flexion", "skullbase_tilt")
SYNCS = ("start", "ready", "strokeStart", "stroke", "strokeEnd", "relax", "end")
FETCHED = re.compile(r'(?:src|href)="(?!data:|#)|url\((?!#)|@import')


class Still:
    """Dynamics of a body without weight."""

    def __init__(self, robot: Robot) -> None:
        self.count = len(robot.skeleton.hinges)

    def torques(self, angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
        return np.zeros_like(angles)

    def acceleration_limits(self) -> Floats:
        return np.full(self.count, 30.0)

    def clearance(self, angles: Floats) -> Clearance:
        return Clearance(np.full(len(angles), 0.05), [("r_wrist", "vl5")] * len(angles))


def made(ids: tuple[str, ...] = ("hello", "offer"), *, seconds: float = 6.0) -> Performance:
    """Gestures with a word each, the first a little late, in a twin that lags by 20 ms."""
    robot = Robot.load()
    body = Still(robot)
    facts = Facts(robot, Style.load(), Lexicon.load(), DurationModel(), body, body)
    keys = np.linspace(0.0, seconds, 7 * len(ids))
    angles = _waving(robot, keys)
    delay = np.where(np.arange(len(keys)) > 2, 0.08, 0.0)
    keyed = np.ones(angles.shape, dtype=bool)
    wished, planned = (
        spline(times, angles, keyed, Manner(), np.ones_like(angles), zero=0.0) for times in (keys, keys + delay)
    )
    syncs = tuple(
        SyncTime(name, sync, float(keys[7 * k + j]), float((keys + delay)[7 * k + j]))
        for k, name in enumerate(ids)
        for j, sync in enumerate(SYNCS)
    )
    timeline = _timeline(ids, syncs)
    outcomes = {b.id: Outcome("realised") for b in timeline.block.behaviours} | {
        ids[-1]: Outcome("substituted", f"nearest to {ids[-1]}")
    }
    uses = {name: frozenset({"r_hand", "l_hand"}) for name in ids}
    times = np.arange(0.0, planned.duration + 0.3, 0.01)
    performed = planned.sample(times - 0.02)[0]
    plan = Plan(
        facts=facts,
        timeline=timeline,
        utterances={"speech": Utterance(3.0, {"one": 1.2})},
        keyframes=KeyFrames(timeline, (), outcomes, uses),
        postures=Postures(
            tuple(Posture(float(t), sealed(a), (True,) * len(a)) for t, a in zip(keys, angles, strict=True)), {}
        ),
        wished=wished,
        motion=Conditioned(planned, keys, keys + delay, None),
        clearance=body.clearance(performed),
        clearance_times=times,
        syncs=syncs,
        notices=(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"block:{ids[0]}", f"{ids[0]} is late"),),
        seconds=0.1,
    )
    origins = robot.skeleton.frames(performed).origins
    wrists = {side: robot.skeleton.segment(robot.chains[f"{side}_arm"][-1]) for side in SIDES}
    measured = Measurements(
        times,
        performed,
        np.gradient(performed, times, axis=0),
        np.zeros_like(performed),
        np.zeros_like(performed),
        {side: origins[:, wrist] for side, wrist in wrists.items()},
        Clearance(0.05 + 0.03 * np.sin(times), [("r_wrist", "vl5")] * len(times)),
    )
    return Performance(plan, measured, np.zeros_like(performed), 0.001, 0.05)


def _waving(robot: Robot, keys: Floats) -> Floats:
    angles = np.repeat(robot.skeleton.rest[None], len(keys), axis=0)
    for k, name in enumerate(MOVED):
        joint = robot.skeleton.joint(name)
        middle = (robot.skeleton.lower[joint] + robot.skeleton.upper[joint]) / 2
        wave = np.sin(keys * (1.0 + 0.2 * k)) * np.sin(np.pi * keys / keys[-1])
        angles[:, joint] += (middle - angles[:, joint]) * np.abs(wave)
    return angles


def _timeline(ids: tuple[str, ...], syncs: tuple[SyncTime, ...]) -> Timeline:
    speech = Behaviour("speech", "speech", Speech(Script("Hello there, welcome", (Mark("one", 13),))), Place(1, 1))
    nod = Behaviour("nod", "head", Head("NOD"), Place(2, 1))
    gestures = [Behaviour(name, "gesture", Gesture("beat"), Place(3, 1)) for name in ids]
    block = Block("block", (speech, nod, *gestures))
    asked: dict[str, dict[str, float]] = {"speech": {"start": 0.2, "one": 1.4, "end": 3.2}, "nod": {"start": 0.0}}
    for sync in syncs:
        asked.setdefault(sync.behaviour, {})[sync.sync] = sync.asked
    return Timeline(block, tuple(Timed(behaviour, asked[behaviour.id]) for behaviour in block.behaviours))


class Outline(HTMLParser):
    """Tags and text of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)

    def handle_data(self, data: str) -> None:
        self.words.append(data)


@pytest.fixture(scope="module")
def performance() -> Performance:
    return made()


@pytest.fixture(scope="module")
def data(performance: Performance) -> dict[str, Json]:
    return report(performance, source="made.bml")


def page(performance: Performance, data: dict[str, Json], folder: Path, film: Path | None = None) -> str:
    path = folder / "report.html"
    write_page(performance, data, film=film, path=path)
    return path.read_text(encoding="utf-8")


def test_page_says_the_verdict_first_and_holds_every_table(
    performance: Performance, data: dict[str, Json], tmp_path: Path
) -> None:
    text = page(performance, data, tmp_path)
    words = " ".join(Outline(text).words)
    assert words.index(verdict(data), words.index("}")) < words.index("collision.plan")
    for row in (*data["checks"], *data["behaviours"], *data["warnings"]):
        for value in row.values():
            assert number(value) in words
    assert "hello is late" in words
    assert "No film: not recorded" in words


def test_what_needs_attention_comes_first(performance: Performance, data: dict[str, Json], tmp_path: Path) -> None:
    words = Outline(page(performance, data, tmp_path)).words
    statuses = [word for word in words if word in ("fail", "warn", "pass")]
    outcomes = [word for word in words if word in ("dropped", "substituted", "realised")]
    assert statuses == sorted(statuses, key=("fail", "warn", "pass").index)
    assert outcomes == ["substituted", "realised", "realised", "realised"]


def test_page_needs_nothing_beside_itself(performance: Performance, data: dict[str, Json], tmp_path: Path) -> None:
    text = page(performance, data, tmp_path)
    assert not FETCHED.search(text)
    assert not {"script", "link", "iframe", "object"} & set(Outline(text).tags)
    assert len(text) < 1_500_000


def test_page_is_the_same_every_time(performance: Performance, data: dict[str, Json], tmp_path: Path) -> None:
    assert page(performance, data, tmp_path) == page(performance, data, tmp_path)


def test_film_becomes_part_of_the_page(performance: Performance, data: dict[str, Json], tmp_path: Path) -> None:
    film = tmp_path / "film.webp"
    film.write_bytes(b"RIFF....WEBP")
    assert base64.b64encode(b"RIFF....WEBP").decode() in page(performance, data, tmp_path, film)
    with pytest.raises(ValueError, match=r"film\.mp4 cannot be shown"):
        page(performance, data, tmp_path, tmp_path / "film.mp4")


def test_names_from_strangers_stay_text(tmp_path: Path) -> None:
    performance = made((HOSTILE, "b\n\x07"))
    text = page(performance, report(performance, source=HOSTILE), tmp_path)
    assert "<script" not in text
    assert HOSTILE in " ".join(Outline(text).words)


def test_figures_are_well_formed_and_show_the_hinges_that_move(
    performance: Performance, data: dict[str, Json], tmp_path: Path
) -> None:
    text = page(performance, data, tmp_path)
    figures = re.findall(r"<svg.*?</svg>", text, flags=re.DOTALL)
    words = {element.text for drawn in figures for element in ElementTree.fromstring(drawn).iter()}
    assert len(figures) == 5  # score, margins, neck, arms, hands
    assert {*MOVED, "hello", "offer", "Hello there,", "welcome"} <= words
    assert set(still(performance)) == set(performance.plan.facts.robot.skeleton.names) - set(MOVED)
    assert not words & set(still(performance))


def test_colours_are_those_of_the_page(performance: Performance, data: dict[str, Json], tmp_path: Path) -> None:
    text = page(performance, data, tmp_path)
    used = set(re.findall(r"var\((--\w+)\)", text))
    defined = set(re.findall(r"(--\w+):", text))
    assert used <= defined
    figures = "".join(re.findall(r"<svg.*?</svg>", text, flags=re.DOTALL))
    assert not re.findall(r"(?:fill|stroke): #(?!ffffff|000000)\w{6}", figures)


def test_a_block_where_nothing_happens_has_a_page(tmp_path: Path) -> None:
    performance = made(("a",), seconds=0.5)
    plan = performance.plan
    empty = Timeline(Block("block", ()), ())
    still_plan = replace(
        plan, timeline=empty, keyframes=KeyFrames(empty, (), {}), postures=Postures((), {}), syncs=(), notices=()
    )
    performance = replace(performance, plan=still_plan)
    text = page(performance, report(performance, source="empty.bml"), tmp_path)
    assert "The block is empty." in text
    assert "Nothing is performed." in text


def test_verdict_names_what_fails(data: dict[str, Json]) -> None:
    fine = verdict(data)
    assert fine.startswith("ok: made.bml on upper22, 6.08 s, nothing fails; ")
    assert fine.endswith("1 warning")
    wrong: dict[str, Json] = {
        "name": "collision.twin",
        "status": "fail",
        "value": 0.004,
        "limit": 0.01,
        "unit": "m",
        "where": "",
    }
    assert "fail: made.bml on upper22, 6.08 s, collision.twin 0.004 (limit 0.01)" in verdict(data | {"checks": [wrong]})


@pytest.mark.parametrize(
    ("value", "text"), [(None, "\u2013"), (0.012345, "0.0123"), (12345.6, "12346"), (True, "True"), ("a", "a")]
)
def test_number(value: Json, text: str) -> None:
    assert number(value) == text


def test_thinned_keeps_the_extremes() -> None:
    times = np.arange(120_000) / 100
    values = np.sin(times)
    values[77_777], values[4_321] = 5.0, -5.0
    few_times, few = thinned(times, values)
    assert len(few) <= POINTS + 2
    assert (few.max(), few.min()) == (5.0, -5.0)
    assert few_times[0] == times[0]
    assert few_times[-1] == times[-1]
    assert (np.diff(few_times) > 0).all()


def test_labels_fit() -> None:
    assert shortened("short", 3.0) == "short"
    assert shortened("a very long name of a behaviour", 1.0).endswith("\u2026")
    assert shortened("long", 0.01) == ""
    assert apart([0.0, 0.1, 1.0, 1.4, 2.1], 1.0) == [0, 2, 4]
