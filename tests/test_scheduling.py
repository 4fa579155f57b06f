"""Order of test files in each process."""

from pathlib import Path

import pytest

from .scheduling import IndexedTests, begin_elsewhere, choose_file, package_of, rank


def test_each_test_process_collects_all_files_in_another_order():
    nodes = list(range(10))
    turned = [begin_elsewhere(nodes, f"gw{k}", 3) for k in range(3)]
    assert all(sorted(own) == nodes for own in turned)
    assert [own[0] for own in turned] == [0, 3, 6]


def test_larger_test_files_come_first_and_files_of_equal_size_in_order_of_name(tmp_path: Path):
    files = [tmp_path / name for name in ("test_b.py", "test_a.py", "test_large.py")]
    for file, size in zip(files, (3, 3, 9), strict=True):
        file.write_text("#" * size)
    results = sorted(files, key=lambda file: rank(file, tmp_path))
    assert [file.name for file in results] == ["test_large.py", "test_a.py", "test_b.py"]


FILE_TEXTS = {  # test files by size, the largest first
    "tests/sum/test_large.py": "",
    "tests/clock/test_tick.py": "pytest.mark.realtime",
    "tests/page/test_page.py": "from ..chromium import opened",
    "tests/studio/test_words.py": "",
    "tests/sum/test_small.py": "",
    "tests/face/test_eyes.py": "",
}


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for name, text in FILE_TEXTS.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def test_pages_and_clocks_have_a_process_each_beside_calculations(root: Path):
    chosen = {worker: choose_file(FILE_TEXTS, worker, root, {}) for worker in ("gw0", "gw1", "gw2")}
    assert chosen == {
        "gw0": "tests/page/test_page.py",
        "gw1": "tests/clock/test_tick.py",
        "gw2": "tests/sum/test_large.py",
    }
    pages = [name for name in FILE_TEXTS if "test_page" in name or "test_tick" in name]
    assert choose_file(pages, "gw2", root, {}) == "tests/clock/test_tick.py"
    assert choose_file(pages[1:], "gw2", root, {}) == "tests/page/test_page.py"


def test_process_stays_in_its_package_while_files_of_its_kind_remain(root: Path):
    assert choose_file(FILE_TEXTS, "gw2", root, {"gw2": "tests/face"}) == "tests/face/test_eyes.py"
    assert choose_file(FILE_TEXTS, "gw0", root, {"gw0": "tests/studio"}) == "tests/studio/test_words.py"
    assert choose_file(FILE_TEXTS, "gw0", root, {"gw0": "tests/sum"}) == "tests/page/test_page.py"


def test_process_begins_a_package_of_another_process_last(root: Path):
    assert choose_file(FILE_TEXTS, "gw2", root, {"gw3": "tests/sum"}) == "tests/face/test_eyes.py"
    assert choose_file(list(FILE_TEXTS)[:4], "gw2", root, {"gw3": "tests/sum"}) == "tests/sum/test_large.py"


def test_package_of_a_test_is_its_folder_below_tests_or_its_file():
    assert package_of("tests/face/render/test_shadow.py") == "tests/face"
    assert package_of("tests/test_lock.py") == "tests/test_lock.py"


def test_positions_of_indexed_tests_equal_those_of_a_list():
    names = ["b", "a", "c"]
    assert [IndexedTests(names).index(name) for name in names] == [0, 1, 2]
    assert IndexedTests(names) == names
