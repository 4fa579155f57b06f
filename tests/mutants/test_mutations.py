import ast
from pathlib import Path

import pytest

from .listed import read_equivalent, read_targets
from .mutations import find_sites

HERE = Path(__file__).parent
TREE = HERE.parent.parent
PARSED_SITES = 4  # number of sites per module whose mutants are parsed
MODULES = {module: tests for part in read_targets().values() for module, tests in part.items()}


def changes_of(source: str) -> set[tuple[str, str]]:
    """Return the old and new text of each change of a source."""
    text = source.encode()
    return {edit.lines(text) for site in find_sites(text) for edit in site}


@pytest.mark.parametrize(
    ("was", "now"),
    [
        ("x = a < b", {"x = a <= b", "x = a > b"}),
        ("x = a + (b)", {"x = a - (b)"}),
        ("x = a and b and c", {"x = a or b and c", "x = a and b or c"}),
        ("x = not a", {"x = (a)"}),
        ("x = -a", {"x = (a)"}),
        ("x = np.minimum(a, b)", {"x = np.maximum(a, b)"}),
        ("x = 3", {"x = 6", "x = 300", "x = 0", "x = 4", "x = 2"}),
        ("x = 0.5", {"x = 1.0", "x = 50.0", "x = 0.0", "x = 1.5"}),
        ("x = a if b else c", {f"x = a if {test} else c" for test in ("not (b)", "True", "False")}),
        ("x = [a for a in b if c]", {f"x = [a for a in b if {test}]" for test in ("not (c)", "True", "False")}),
        ("forget(x)", {"pass"}),
        ("x.y = z", {"pass"}),
        ("x += y", {"x -= y", "pass"}),
        ("raise ValueError(f'{1 + 1} is not {2}')", {"pass"}),
        ("x: int = a * b", {"x: int = a / b"}),
        ("x = f(a, (b), c)", {"x = f(b, (a), c)"}),
        ("x = f(a, a)", set()),
        ("x = f(a, *b)", set()),
        ("x = isinstance(a, b)", set()),
        ("x = a.get(b, c)", {"x = a.get(b)"}),
        ("x = next(a, None)", {"x = next(a)"}),
        ("x = a[b:]", {"x = a[(b) + 1:]", "x = a[:]"}),
        ("x = f(x)", {"pass"}),
        ("a.x, b[y] = z", {"pass"}),
        ("a.x = b.x = z", {"pass"}),
        ("a.x, b = z", set()),
    ],
)
def test_each_sample_source_line_gives_its_listed_mutants(was: str, now: set[str]):
    assert changes_of(was) == {(was, item) for item in now}


def test_mutants_of_a_function_change_defaults_or_return_early():
    source = 'def go(speed: float = 2.0) -> None:\n    """Goes."""\n    way = find(speed)\n'
    assert changes_of(source) == {
        ("way = find(speed)", "return"),
        *(
            ("def go(speed: float = 2.0) -> None:", f"def go(speed: float = {value}) -> None:")
            for value in (4.0, 200.0, 0.0, 3.0)
        ),
    }


@pytest.mark.parametrize(
    ("returned", "now"),
    [
        ("bool", {"return True", "return False"}),
        ("list[str]", {"return []"}),
        ("tuple[int, ...]", {"return ()"}),
        ("Plan | None", {"return None"}),
    ],
)
def test_mutant_returns_an_empty_or_constant_value_of_the_annotated_type(returned: str, now: set[str]):
    """Mutants of an outer function leave the returns of inner functions."""
    source = f"def find() -> {returned}:\n    def inner():\n        return y\n    return x\n"
    assert {(was, each) for was, each in changes_of(source) if was == "return x"} == {
        ("return x", item) for item in now
    }
    assert ("return y", "return None") in changes_of(source)


def test_mutant_equal_to_its_source_is_left_out():
    assert changes_of("def find() -> bool:\n    return False\n") == {("return False", "return True")}


def test_guard_of_a_match_case_is_mutated_like_a_condition():
    source = "match x:\n    case y if z:\n        go()\n"
    assert changes_of(source) == {
        ("go()", "pass"),
        *(("case y if z:", f"case y if {test}:") for test in ("not (z)", "True", "False")),
    }


def test_asynchronous_functions_have_the_same_mutants_as_synchronous_ones():
    source = 'async def go() -> None:\n    """Goes."""\n    await f(a, b)\n'
    assert changes_of(source) == {("await f(a, b)", item) for item in ("return", "pass", "await f(b, a)")}


@pytest.mark.parametrize(
    "source",
    [
        '"""1 + 1"""',
        "import x",
        "x: list[int]",
        "assert 1 + 1 == 2",
        "x = f'{1}'",
        "Both = One | Other",
        "x = 'text'",
        "x = check(a, strict=True)",
    ],
)
def test_mutation_tool_leaves_docstrings_imports_annotations_assertions_and_texts_unchanged(source: str):
    assert not find_sites(source.encode())


def test_mutation_changes_no_other_bytes_of_the_source():
    source = "x = 'ü' + y  # ä\nz = x < y\n".encode()
    changed = {edit.apply(source).decode() for site in find_sites(source) for edit in site}
    assert "x = 'ü' - y  # ä\nz = x < y\n" in changed
    assert "x = 'ü' + y  # ä\nz = x <= y\n" in changed
    (last,) = {edit.line(source) for edit in find_sites(source)[-1]}
    assert last == 2


def test_modules_listed_for_mutation_tests_and_their_tests_exist():
    assert [module for module in MODULES if not (TREE / module).is_file()] == []
    assert [tests for module in MODULES for tests in MODULES[module] if not (TREE / tests).is_file()] == []


@pytest.mark.parametrize(
    "module", [pytest.param(name, marks=[pytest.mark.soak] * (k % 8 > 0)) for k, name in enumerate(MODULES)]
)
def test_mutants_of_modules_listed_for_mutation_tests_are_valid_python(module: str):
    source = (TREE / module).read_bytes()
    sites = find_sites(source)
    assert sites
    for site in sites[:: 1 + len(sites) // PARSED_SITES]:
        ast.parse(site[0].apply(source))


def test_each_listed_equivalent_mutant_exists_in_the_source_and_has_a_reason():
    """A reworded source line must be judged and listed again."""
    listed = read_equivalent()
    known = {
        module: {edit.lines(source) for site in find_sites(source) for edit in site}
        for module in {module for module, _, _ in listed}
        for source in [(TREE / module).read_bytes()]
    }
    for (module, was, now), why in listed.items():
        assert (was, now) in known[module], (module, was, now)
        assert len(why) > 10


def test_each_module_for_mutation_tests_is_listed_in_only_one_target_file():
    assert len(MODULES) == sum(map(len, read_targets().values()))
