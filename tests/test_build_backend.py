"""Choice of the compiler, and of Python's headers, when the extension is built."""

import re
import shutil
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

pytest.importorskip("setuptools", minversion="77", reason="a setuptools that can build is not installed")


@pytest.fixture
def backend(monkeypatch):
    """The build backend, with the source folder as its working folder."""
    monkeypatch.syspath_prepend(str(ROOT))
    monkeypatch.chdir(ROOT)
    import build_backend  # noqa: PLC0415 - it is no part of the package

    return build_backend


def hide_compilers(backend, monkeypatch):
    monkeypatch.delenv("CXX", raising=False)
    monkeypatch.setattr(backend.shutil, "which", lambda name: None)
    monkeypatch.setattr(backend.sys, "platform", "linux")
    monkeypatch.setattr(backend.platform, "machine", lambda: "x86_64")


def test_build_with_an_installed_compiler_does_not_require_zig(backend, monkeypatch):
    monkeypatch.setattr(backend.shutil, "which", lambda name: f"/usr/bin/{name}")
    assert backend.missing_compiler() == []
    assert not any("zig" in name for name in backend.get_requires_for_build_wheel())


def test_build_on_linux_without_a_compiler_requires_zig(backend, monkeypatch):
    hide_compilers(backend, monkeypatch)
    assert any(name.startswith("ziglang") for name in backend.get_requires_for_build_wheel())
    assert any(name.startswith("ziglang") for name in backend.get_requires_for_build_editable())


@pytest.mark.parametrize(("system", "processor"), [("darwin", "arm64"), ("win32", "AMD64"), ("linux", "riscv64")])
def test_build_on_other_platforms_does_not_require_zig(backend, monkeypatch, system: str, processor: str):
    hide_compilers(backend, monkeypatch)
    monkeypatch.setattr(backend.sys, "platform", system)
    monkeypatch.setattr(backend.platform, "machine", lambda: processor)
    assert not backend.needs_zig()


def test_build_with_a_compiler_named_in_cxx_does_not_require_zig(backend, monkeypatch):
    hide_compilers(backend, monkeypatch)
    monkeypatch.setenv("CXX", "my-c++ -pipe")
    monkeypatch.setattr(backend.shutil, "which", lambda name: "/opt/my-c++" if name == "my-c++" else None)
    assert not backend.needs_zig()


@pytest.mark.skipif(shutil.which("sh") is None, reason="no shell")
def test_zig_compiles_for_glibc_2_28(backend, monkeypatch, tmp_path):
    monkeypatch.setattr(backend.platform, "machine", lambda: "aarch64")
    program = Path(backend.write_zig(tmp_path / "build"))
    text = program.read_text()
    assert f"exec {sys.executable} -m ziglang c++ -target aarch64-linux-gnu.2.28" in text
    assert program.stat().st_mode & 0o100


def test_missing_python_headers_are_reported_with_a_remedy(backend, monkeypatch, tmp_path):
    monkeypatch.setattr(backend.sysconfig, "get_path", lambda name: str(tmp_path / "nowhere"))
    monkeypatch.setattr(backend.shutil, "which", lambda name: None)
    with pytest.raises(FileNotFoundError, match="python3-dev"):
        backend.python_headers(tmp_path / "headers")


def test_no_python_headers_are_fetched_if_the_interpreter_has_them(backend, monkeypatch, tmp_path):
    (tmp_path / "Python.h").touch()
    monkeypatch.setattr(backend.sysconfig, "get_path", lambda name: str(tmp_path))
    assert backend.python_headers(tmp_path / "headers") == []


def test_published_wheel_is_compiled_by_zig_for_its_processor(backend, monkeypatch, tmp_path):
    monkeypatch.setattr(backend.sys, "platform", "linux")
    monkeypatch.setattr(backend.shutil, "which", lambda name: f"/usr/bin/{name}")
    monkeypatch.setattr(backend.platform, "machine", lambda: "x86_64")
    monkeypatch.setenv("KINESIC_WHEEL_TARGET", "aarch64")
    assert backend.needs_zig()
    assert "-target aarch64-linux-gnu.2.28" in Path(backend.write_zig(tmp_path)).read_text()


@pytest.mark.parametrize(
    ("version", "requested", "expected"), [((3, 11), "1", False), ((3, 12), "1", True), ((3, 14), "0", False)]
)
def test_stable_abi_is_used_only_on_request_and_from_python_3_12(backend, monkeypatch, version, requested, expected):
    monkeypatch.setattr(backend.sys, "version_info", (*version, 1))
    monkeypatch.setenv("KINESIC_ABI3", requested)
    assert backend.uses_stable_abi() is expected


def test_readme_on_pypi_shows_pictures_and_pages_of_its_version(backend, monkeypatch):
    monkeypatch.delenv("KINESIC_HOME", raising=False)
    plain = backend.published_readme()
    assert "](docs/pictures/greeting.webp)" in plain
    monkeypatch.setenv("KINESIC_HOME", "https://example.org/kinesic/")
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    linked = backend.published_readme()
    assert f"](https://example.org/kinesic/raw/v{version}/docs/pictures/greeting.webp)" in linked
    assert f"[CITATION.cff](https://example.org/kinesic/blob/v{version}/CITATION.cff)" in linked
    assert re.findall(r"\]\((?!https://)[^)]*\)", linked) == []
    assert len(linked.splitlines()) == len(plain.splitlines())
