"""What browsers are told that a page may do."""

import hashlib
from base64 import b64encode

from kinesic.report.content_policy import content_policy


def test_page_runs_its_own_script_and_nothing_else():
    digest = b64encode(hashlib.sha256(b"tell();").digest()).decode()
    assert content_policy("tell();") == (
        f"default-src 'none'; script-src 'sha256-{digest}'; style-src 'unsafe-inline'; base-uri 'none'; "
        "form-action 'none'"
    )


def test_page_may_show_what_it_names():
    found = content_policy("", img_src="data:", media_src="blob:")
    assert found.endswith("; form-action 'none'; img-src data:; media-src blob:")
