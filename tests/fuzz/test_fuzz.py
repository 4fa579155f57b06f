from pathlib import Path
from random import Random

import pytest

from tests.fuzz.mutations import Pool, mutate, outcome_of
from tests.fuzz.target_names import TARGET_NAMES
from tests.fuzz.targets import Target, list_targets

CORPUS_FOLDER = Path(__file__).with_name("corpus")  # inputs that once failed, by target
MUTATION_COUNT = 5  # number of mutated inputs of each target


@pytest.fixture(scope="module")
def targets(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Target]:
    return dict(list_targets(tmp_path_factory.mktemp("files")))


def test_every_fuzz_target_is_listed_and_accepts_its_valid_inputs(targets: dict[str, Target]):
    assert tuple(targets) == TARGET_NAMES
    for name, target in targets.items():
        assert [outcome_of(target.read, seed, target.refusals) for seed in target.seeds] == [""] * len(target.seeds), (
            name
        )


def test_stored_inputs_that_once_failed_are_read_or_refused(targets: dict[str, Target]):
    inputs = sorted(path for path in CORPUS_FOLDER.glob("*/*") if path.is_file())
    assert {path.parent.name for path in inputs} <= set(targets)
    for path in inputs:
        target = targets[path.parent.name]
        outcome_of(target.read, path.read_bytes(), target.refusals)


def test_mutated_inputs_of_each_fuzz_target_are_read_or_refused(targets: dict[str, Target]):
    refused = 0
    for name, target in targets.items():
        pool = Pool(target.seeds, Random(name))
        refused += sum(outcome_of(target.read, pool.draw(), target.refusals) != "" for _ in range(MUTATION_COUNT))
    assert refused > len(targets)


def test_fuzzer_passes_on_errors_that_are_no_expected_refusals():
    def read(data: bytes) -> int:
        if data == b"refused":
            raise ValueError("refused: 3")
        return data[7]

    assert outcome_of(read, b"refused", (ValueError,)) == "refused: 3"
    assert outcome_of(read, b"accepted", (ValueError,)) == ""
    with pytest.raises(IndexError):
        outcome_of(read, b"short", (ValueError,))


def test_fuzzer_keeps_only_inputs_with_a_new_outcome():
    pool = Pool((b"seed",), Random(1))
    for data, outcome in ((b"x1", "line 3: 'a' is bad"), (b"x2", "line 77: 'b' is bad"), (b"x3", "no such key")):
        pool.keep(data, outcome)
    starts = {pool.draw()[:2] for _ in range(300)}
    assert {b"x1", b"x3"} <= starts
    assert mutate(b"", Random(3), [b""]) is not None


def test_fuzzer_draws_the_same_mutated_inputs_for_the_same_random_seed():
    first, second = (Pool((b"<a b='1'/>",), Random(5)) for _ in range(2))
    assert [first.draw() for _ in range(50)] == [second.draw() for _ in range(50)]
