from dataclasses import dataclass, field

import pytest

from kinesic.body.config import ConfigError
from kinesic.studies.designs.search import BASE_DESIGN, document_steps, search
from kinesic.studies.designs.trial import DesignTask, Trial
from kinesic.tasks.journal import Journal

BLOCK_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
NOD = BLOCK_TEMPLATE.format('<head id="h" lexeme="NOD" start="0.2"/>').encode()
WALK = BLOCK_TEMPLATE.format('<locomotion id="w" target="door"/>').encode()
WEAK_DESIGN = (("l_shoulder_[fa]*.servo", "xc330_t288"),)
WIDE_DESIGN = (("l_sternoclavicular.length", "0.03"),)
GEARED_DESIGN = (("l_shoulder_flexion.reduction", "2"),)
CHEAP_DESIGN = (("l_elbow_flexion.servo", "xc430_w240"),)


@dataclass
class Here:
    """Engine without processes that records its tasks."""

    done: list[DesignTask] = field(default_factory=list)
    place: str = "here"

    def run(self, tasks, prepare, *, preload=""):
        do = prepare()
        for task in tasks:
            self.done.append(task)
            yield task, do(task)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("search")


@pytest.fixture(scope="module")
def found(folder):
    designs = (WEAK_DESIGN, WIDE_DESIGN, GEARED_DESIGN, CHEAP_DESIGN)
    documents = [("nod.bml", NOD), ("walk.bml", WALK)]
    journal = Journal(folder / "finished.jsonl", Trial)
    return search("upper22", designs, documents, engine=Here(), journal=journal)


def test_robot_designs_that_collide_sag_or_cannot_be_built_are_excluded(found):
    reasons = {trial.design: trial.out for trial in found.out}
    assert set(reasons) == {WEAK_DESIGN, WIDE_DESIGN, GEARED_DESIGN}
    assert "does not hold itself" in reasons[WEAK_DESIGN]
    assert "collides: at rest" in reasons[WIDE_DESIGN]
    assert "turns its servo by 440 degrees" in reasons[GEARED_DESIGN]


def test_design_search_evaluates_base_robot_and_cheaper_design_in_all_rounds(found):
    figures = {trial.design: trial for trial in found.finished}
    assert set(figures) == {BASE_DESIGN, CHEAP_DESIGN}
    assert figures[CHEAP_DESIGN].body.price == pytest.approx(figures[BASE_DESIGN].body.price - 300.0)
    assert figures[CHEAP_DESIGN].body.mass == pytest.approx(figures[BASE_DESIGN].body.mass - 2 * 0.017)
    assert all(len(trial.documents) == 2 for trial in found.finished)
    assert figures[CHEAP_DESIGN].violations == 1  # nobody walks
    assert [(each.documents, each.designs) for each in found.rounds] == [(1, 2), (2, 2)]


def test_design_search_resumes_after_a_crash(folder, found):
    lines = (folder / "finished.jsonl").read_bytes()
    (folder / "again.jsonl").write_bytes(lines[:-5])  # killed while it wrote the last result
    engine = Here()
    again = search(
        "upper22",
        (WEAK_DESIGN, WIDE_DESIGN, GEARED_DESIGN, CHEAP_DESIGN),
        [("nod.bml", NOD), ("walk.bml", WALK)],
        engine=engine,
        journal=Journal(folder / "again.jsonl", Trial),
    )
    assert again == found
    assert len(engine.done) == 1
    assert (folder / "again.jsonl").read_bytes().count(b"\n") == lines.count(b"\n")


def test_task_key_of_a_design_search_depends_on_design_documents_and_setup():
    keys = {
        DesignTask(CHEAP_DESIGN, (("a", NOD),), "x").key,
        DesignTask(CHEAP_DESIGN, (("a", WALK),), "x").key,
        DesignTask(CHEAP_DESIGN, (("a", NOD),), "y").key,
        DesignTask(BASE_DESIGN, (("a", NOD),), "x").key,
    }
    assert len(keys) == 4


def test_number_of_documents_triples_with_each_round_of_the_design_search():
    documents = [(str(number), b"") for number in range(18)]
    steps = document_steps(documents)
    assert [len(step) for step in steps] == [2, 4, 12]
    assert sorted(name for step in steps for name, _ in step) == sorted(name for name, _ in documents)
    assert [len(step) for step in document_steps(documents[:1])] == [1]


def test_design_search_refuses_a_base_robot_that_cannot_hold_its_weight(tmp_path):
    (tmp_path / "weak.toml").write_text(
        '[robot]\nname = "weak"\nextends = "upper22"\n[[hinge]]\nname = "vl5_roll"\nservo = "xc330_t288"\n'
    )
    with pytest.raises(ConfigError, match=r"weak\.toml itself is rejected: it does not hold itself: vl5_roll"):
        search(str(tmp_path / "weak.toml"), [], [("nod.bml", NOD)], engine=Here())
