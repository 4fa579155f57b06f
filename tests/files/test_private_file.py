import os
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.files.private_file import MAX_SECRET_BYTES, check_private, read_secret


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    path = tmp_path / "token"
    path.touch(0o600)
    path.write_text(" open sesame \nsecond line\n")
    return path


def test_secret_is_the_first_line_of_the_secret_file(secret: Path):
    assert read_secret(secret, "--token-file") == "open sesame"


def test_secret_is_read_from_a_shell_pipe():
    read, write = os.pipe()
    os.write(write, b"open sesame\n")
    os.close(write)
    assert read_secret(Path(f"/dev/fd/{read}"), "--token-file") == "open sesame"
    os.close(read)


@pytest.mark.parametrize("mode", [0o640, 0o604, 0o644, 0o660])
def test_secret_readable_by_others_is_refused(secret: Path, mode: int):
    secret.chmod(mode)
    match = rf"--token-file .*token: other users can read it \(mode {mode:o}\); chmod 600"
    with pytest.raises(ConfigError, match=match):
        read_secret(secret, "--token-file")
    with pytest.raises(ConfigError, match=match):
        check_private(secret, "--token-file")


@pytest.mark.parametrize("content", [b"", b"\n", b"  \nx", b"x" * (MAX_SECRET_BYTES + 1)])
def test_empty_or_too_long_secret_is_refused(secret: Path, content: bytes):
    secret.write_bytes(content)
    with pytest.raises(ConfigError, match=r"its first line must hold 1 to 4096 bytes"):
        read_secret(secret, "--token-file")


def test_binary_or_missing_secret_file_is_refused(secret: Path, tmp_path: Path):
    secret.write_bytes(b"\xff\n")
    with pytest.raises(ConfigError, match="not text in UTF-8"):
        read_secret(secret, "--token-file")
    with pytest.raises(ConfigError, match="No such file"):
        read_secret(tmp_path / "none", "--token-file")
    with pytest.raises(ConfigError, match="No such file"):
        check_private(tmp_path / "none", "--tls-key")
