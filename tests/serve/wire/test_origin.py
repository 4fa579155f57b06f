from http import HTTPStatus

import pytest
from hypothesis import given
from hypothesis import strategies as st
from websockets.datastructures import Headers

from kinesic.body.config import ConfigError
from kinesic.serve.wire import origin
from kinesic.serve.wire.origin import OPEN_ACCESS, Access, find_rejection, own_authorities, read_origin

LOCAL_AUTHORITIES = own_authorities("127.0.0.1", "127.0.0.1", 8864)
ALLOWED_ORIGINS = frozenset({"https://studio.example", "http://localhost:5173"})


def status(*pairs, origins=frozenset(), authorities=LOCAL_AUTHORITIES):
    """Return the HTTP status of a refusal, or None."""
    headers = Headers()
    for name, value in pairs:
        headers[name] = value
    rejection = find_rejection(headers, authorities, origins)
    return None if rejection is None else rejection.status


@pytest.mark.parametrize("host", ["127.0.0.1:8864", "localhost:8864", "LocalHost:8864", "[::1]:8864"])
def test_program_without_origin_header_may_use_any_host_name(host):
    assert status(("hOST", host)) is None


@pytest.mark.parametrize("page", ["http://127.0.0.1:8864", "https://localhost:8864", "http://[::1]:8864"])
def test_web_page_of_this_server_may_connect(page):
    assert status(("Host", "localhost:8864"), ("oRiGiN", page)) is None


@pytest.mark.parametrize(
    "page",
    [
        "null",
        "",
        "file://",
        "data:",
        "chrome-extension://abcdefghijklmnop",
        "http://localhost",
        "http://localhost:8865",
        "http://localhost:88640",
        "http://localhost.:8864",
        "http://localhost:8864/",
        "http://localhost:8864@evil.example",
        "http://localhost:8864.evil.example",
        "http://evil.example:8864",
        "http://evil.example#localhost:8864",
        "http://user@localhost:8864",
        "ws://localhost:8864",
        "ftp://localhost:8864",
        "HTTP://LOCALHOST:8864",
        "http://127.1:8864",
        "http://0.0.0.0:8864",
        "http://[::ffff:127.0.0.1]:8864",
        "http://localhost:8864 http://evil.example",
        "http://localhost:8864, http://evil.example",
    ],
)
def test_web_pages_of_other_origins_may_not_connect(page):
    assert status(("Host", "localhost:8864"), ("Origin", page)) == HTTPStatus.FORBIDDEN


@pytest.mark.parametrize(
    "host",
    [
        "evil.example:8864",
        "evil.example",
        "localhost",
        "localhost:8865",
        "localhost.:8864",
        "localhost.evil.example:8864",
        "user@localhost:8864",
        "localhost:8864@evil.example",
        "127.0.0.2:8864",
        "192.168.0.7:8864",
        "::1:8864",
        "[::1%lo]:8864",
        "localhost :8864",
        "",
    ],
)
def test_requests_for_foreign_host_names_are_refused(host):
    assert status(("Host", host)) == HTTPStatus.MISDIRECTED_REQUEST
    assert status(("Host", host), ("Origin", f"http://{host}")) == HTTPStatus.MISDIRECTED_REQUEST


@given(st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=40))
def test_requests_with_an_invalid_or_foreign_origin_header_are_refused(page):
    expected = (
        None if page in {f"{scheme}://{own}" for scheme in ("http", "https") for own in LOCAL_AUTHORITIES} else 403
    )
    assert status(("Host", "localhost:8864"), ("Origin", page)) == expected


def test_requests_with_duplicate_host_or_origin_headers_are_refused():
    host, page = ("Host", "localhost:8864"), ("Origin", "http://localhost:8864")
    assert status(host, host) == HTTPStatus.BAD_REQUEST
    assert status(host, page, page) == HTTPStatus.BAD_REQUEST
    assert status(page) == HTTPStatus.BAD_REQUEST


def test_host_name_of_an_allowed_page_origin_is_accepted():
    assert status(("Host", "localhost:8864"), ("Origin", "http://localhost:5173"), origins=ALLOWED_ORIGINS) is None
    assert status(("Host", "studio.example"), ("Origin", "https://studio.example"), origins=ALLOWED_ORIGINS) is None
    assert status(("Host", "localhost:8864"), ("Origin", "http://studio.example"), origins=ALLOWED_ORIGINS) == 403
    assert status(("Host", "localhost:8864"), ("Origin", "null"), origins=ALLOWED_ORIGINS) == 403


def test_valid_host_headers_depend_on_the_listening_address(monkeypatch):
    monkeypatch.setattr(origin, "gethostname", lambda: "Robot")
    assert own_authorities("192.168.0.7", "192.168.0.7", 5) == {"192.168.0.7:5"}
    assert own_authorities("robot.lab", "192.168.0.7", 5) == {"192.168.0.7:5", "robot.lab:5"}
    assert own_authorities("0.0.0.0", "192.168.0.7", 5) == {"192.168.0.7:5", "robot:5", "robot.local:5"}
    assert own_authorities("::", "fe80::1%eth0", 5) == {"[fe80::1]:5", "robot:5", "robot.local:5"}
    assert "localhost:5" in own_authorities("0.0.0.0", "127.0.0.1", 5)
    assert own_authorities("localhost", "::1", 80) >= {"localhost", "localhost:80", "[::1]"}


@pytest.mark.parametrize("text", ["http://localhost:5173", "HTTPS://Studio.Example", "http://[::1]:80"])
def test_valid_origin_options_of_the_command_line_are_parsed(text):
    assert read_origin(text) == text.lower()


@pytest.mark.parametrize(
    "text", ["null", "*", "localhost:5173", "http://localhost/", "file://", "http://a@b", "http://a:"]
)
def test_invalid_origin_options_of_the_command_line_are_refused(text):
    with pytest.raises(ConfigError, match="give SCHEME://HOST"):
        read_origin(text)


def test_access_without_options_has_no_token_no_foreign_pages_and_no_plain_text():
    assert Access(token=None, origins=frozenset(), texts=False) == OPEN_ACCESS == Access()
