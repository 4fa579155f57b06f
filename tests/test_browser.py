"""Browser pages: only pages of the server reach the robot."""

import json
import threading
from base64 import b64encode
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from kinesic.serve.wire.quotas import Quotas

from .chromium import FOREIGN_HOST, Page, binary, opened
from .serve.conftest import running

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(binary() is None, reason="no Chromium: apt-get install chromium"),
]

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="smuggled"><head id="h" lexeme="NOD" start="0"/></bml>'
ATTACK_SCRIPT = """
const port = {port}, hosts = {hosts}, bml = {bml};
function attempt(host) {{
  return new Promise(done => {{
    let socket;
    try {{ socket = new WebSocket(`ws://${{host}}:${{port}}/`); }} catch (error) {{ done("blocked"); return; }}
    socket.onopen = () => {{ socket.send(bml); socket.send('{{"do": "stop"}}'); done("open"); }};
    socket.onerror = () => done("refused");
  }});
}}
async function post(body, type) {{
  const request = {{method: "POST", mode: "no-cors", body, headers: {{"Content-Type": type}}}};
  for (const host of hosts) await fetch(`http://${{host}}:${{port}}/`, request).catch(() => null);
}}
function form(body) {{
  const frame = document.createElement("iframe"), form = document.createElement("form");
  frame.name = "sink"; document.body.append(frame);
  form.method = "POST"; form.enctype = "text/plain"; form.target = "sink"; form.action = `http://${{hosts[0]}}:${{port}}/`;
  const field = document.createElement("input");
  field.name = body; field.value = ""; form.append(field); document.body.append(form);
  form.submit();
  return new Promise(done => {{ frame.onload = done; setTimeout(done, 1000); }});
}}
async function all() {{
  const found = [];
  for (const host of hosts) found.push(await attempt(host));
  await post(bml, "text/plain"); await post('\\0{{"do": "stop"}}\\0' + bml + '\\0', "text/plain");
  await form(bml);
  return found;
}}
"""
PAGE = "<!doctype html><meta charset=utf-8><body><script>{script}\nconst mine = all();</script>"
IFRAME = """
new Promise(done => {{
  addEventListener("message", event => done(event.data));
  const frame = document.createElement("iframe");
  frame.sandbox = "allow-scripts allow-forms";
  frame.srcdoc = {inner};
  document.body.append(frame);
}})
"""


@pytest.fixture(scope="module")
def plain():
    """Server with default settings, without a token."""
    with running(Quotas(patience=2.0)) as result:
        yield result


@pytest.fixture
def reached(plain, monkeypatch):
    """Messages that reached the session, from any client."""
    results = []
    monkeypatch.setattr(plain.open.clients, "receive", lambda client, message: results.append(message))
    return results


@contextmanager
def web_server(folder: Path) -> Iterator[int]:
    """Serve a folder on a free port, as a web server of another origin."""

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            """Log nothing."""

    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=folder)) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield server.server_port
        finally:
            server.shutdown()
            thread.join()


def settled(page: Page) -> object:
    """Return all results of a page that attempts connections by itself."""
    page.until("typeof mine !== 'undefined'")
    return page.value("mine")


def attempts(page: Page, script: str) -> object:
    """Return the results of the connections that a page's script attempts."""
    page.until("document.readyState === 'complete' && location.port !== ''")
    page.call("Runtime.evaluate", expression=script)
    return page.value("all()")


def attack(port: int, *hosts: str) -> str:
    return ATTACK_SCRIPT.format(port=port, hosts=json.dumps(hosts or ("localhost", "127.0.0.1")), bml=json.dumps(NOD))


def test_server_refuses_connections_of_foreign_pages_and_sandboxed_iframes(plain, reached, tmp_path):
    page = PAGE.format(script=attack(plain.port))
    (tmp_path / "index.html").write_text(page)
    inner = page.replace("const mine = all();", "all().then(found => parent.postMessage(found, '*'));")
    with (
        web_server(tmp_path) as port,
        opened(f"http://{FOREIGN_HOST}:{port}/") as shown,
    ):
        assert settled(shown) == ["refused", "refused"]
        assert shown.value(IFRAME.format(inner=json.dumps(inner))) == ["refused", "refused"]
    assert reached == []


@pytest.mark.parametrize("scheme", ["data", "file"])
def test_server_refuses_connections_of_web_pages_opened_from_a_file_or_data_url(plain, reached, tmp_path, scheme):
    page, file = PAGE.format(script=attack(plain.port)), tmp_path / "page.html"
    file.write_text(page)
    data = f"data:text/html;base64,{b64encode(page.encode()).decode()}"
    url = {"file": file.as_uri(), "data": data}[scheme]
    with opened(url) as shown:
        assert settled(shown) == ["refused", "refused"]
    assert reached == []


def test_server_refuses_a_browser_page_after_dns_rebinding(plain, reached, tmp_path):
    """After rebinding, the browser's same-origin policy gives no protection."""
    with opened(f"http://{FOREIGN_HOST}:{plain.port}/") as shown:
        assert attempts(shown, attack(plain.port, FOREIGN_HOST)) == ["refused"]
    assert reached == []


def test_browser_page_of_the_server_itself_may_connect(plain, reached, tmp_path):
    with opened(f"http://localhost:{plain.port}/") as shown:
        assert attempts(shown, attack(plain.port)) == ["open", "open"]
    assert reached == [NOD.encode(), b'{"do": "stop"}'] * 2
