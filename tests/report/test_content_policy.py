"""Content security policy of the pages."""

import hashlib
from base64 import b64encode

from kinesic.report.content_policy import content_policy


def test_content_policy_allows_only_the_script_with_the_given_hash():
    digest = b64encode(hashlib.sha256(b"tell();").digest()).decode()
    assert content_policy("tell();") == (
        f"default-src 'none'; script-src 'sha256-{digest}'; style-src 'unsafe-inline'; base-uri 'none'; "
        "form-action 'none'"
    )


def test_content_security_policy_allows_the_picture_and_media_sources_of_its_arguments():
    policy = content_policy("", img_src="data:", media_src="blob:")
    assert policy.endswith("; form-action 'none'; img-src data:; media-src blob:")
