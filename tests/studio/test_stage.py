"""Stage in a browser with the real server: drags, their limits, and drawing quality."""

from contextlib import ExitStack
from functools import partial

import pytest

from kinesic.bench.studio import PAGE_GOALS, time_page

from ..chromium import browser, opened
from .conftest import Studio
from .test_attached import relay
from .test_page import WORDS

pytestmark = pytest.mark.realtime


def test_hand_dragged_in_the_studio_shows_its_reach_sector_and_whether_it_reaches_the_pointer(studio: Studio):
    studio.write(WORDS)
    hand = studio.state("right")
    begin, far = (hand["x"], hand["y"]), (hand["x"] - 120, hand["y"] - 150)
    studio.page.drag(begin, (hand["x"] - 5, hand["y"] - 20), (hand["x"] - 10, hand["y"] - 40))
    studio.until("s.reach !== null && s.reach.reached")
    words = studio.page.value("document.querySelector('#stops').textContent")
    assert words.startswith("within reach: X")
    studio.until("document.querySelector('#sectors').hasAttribute('hidden')")  # the hand is released
    studio.page.click("#show-sectors")
    studio.until("!document.querySelector('#sectors').hasAttribute('hidden')")
    assert studio.page.value("document.querySelectorAll('#sectors polygon').length") == 5 * 7
    studio.page.click("#show-sectors")
    hand = studio.state("right")
    studio.page.call(
        "Input.dispatchMouseEvent", type="mousePressed", x=hand["x"], y=hand["y"], button="left", clickCount=1
    )
    studio.page.call(
        "Input.dispatchMouseEvent", type="mouseMoved", x=hand["x"], y=hand["y"] - 12, button="left", buttons=1
    )
    studio.until("document.querySelector('#sectors .current text') !== null")
    outward, up = studio.page.value("document.querySelector('#sectors .current text').textContent").split()
    studio.page.call("Input.dispatchMouseEvent", type="mouseReleased", x=hand["x"], y=hand["y"] - 12, button="left")
    studio.until(f"document.querySelector('#stops').textContent.includes('{outward} {up} Z')")
    hand = studio.state("right")
    studio.page.drag((hand["x"], hand["y"]), far, (far[0] - 300, far[1] - 200))
    studio.until("s.reach !== null && !s.reach.reached")
    assert "short" in studio.page.value("document.querySelector('#stops').textContent")
    assert len(studio.state("latencies")) >= 2


def test_drag_of_the_drawn_hand_reacts_between_frames_and_hides_the_unused_handles(studio: Studio):
    studio.write(WORDS)
    studio.page.click("#mode-plan")
    seen = "[...document.querySelectorAll('#handles i')].filter(dot => getComputedStyle(dot).visibility === 'visible')"
    studio.until("s.left !== null && s.reach === null")
    assert studio.page.value(f"{seen}.length") == 6
    hand = studio.state("left")
    x, y = hand["x"], hand["y"]
    studio.page.call("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, button="left", clickCount=1)
    # raw events arrive at once; `pointermove` waits for the next frame
    raw = f"new PointerEvent('pointerrawupdate', {{clientX: {x + 6}, clientY: {y - 9}}})"
    studio.page.value(f"document.querySelector('#canvas').dispatchEvent({raw})")
    studio.until("s.reach !== null")
    studio.page.until(f"{seen}.length === 1 && {seen}[0].className === 'hand taken'")
    studio.page.call("Input.dispatchMouseEvent", type="mouseReleased", x=x, y=y, button="left")
    studio.page.until(f"{seen}.length === 6")
    studio.page.click("#mode-plan")


@pytest.mark.parametrize(
    ("part", "way", "far", "free", "stops"),
    [
        ("trunk", (8, 4), (500, 40), "the trunk can lean there", "vl5"),
        ("gaze", (25, 20), (10, 300), "the eyes can look there", "skullbase"),
        ("elbow", (0, 0), (0, 1), "the elbow can swing there", ""),
    ],
)
def test_elbow_trunk_and_gaze_can_be_dragged_in_the_studio_and_show_their_limits(
    studio: Studio, part: str, way: tuple[float, float], far: tuple[float, float], free: str, stops: str
):
    studio.write(WORDS)
    studio.page.click("#mode-plan")
    studio.page.click("#view-front")
    studio.until(f"s.{part} !== null && document.querySelector('#stops').textContent === ''")
    handle, said = studio.state(part), "document.querySelector('#stops').textContent"
    x, y = handle["x"], handle["y"]
    studio.page.drag((x, y), (x + way[0] / 2, y + way[1] / 2), (x + way[0], y + way[1]))
    studio.until(f"{said} === {free!r}")
    handle = studio.state(part)
    studio.page.drag((handle["x"], handle["y"]), (x + far[0] / 2, y + far[1] / 2), (x + far[0], y + far[1]))
    if stops:
        studio.until(f"s.reach !== null && !s.reach.reached && {said}.includes('short')")
        assert any(name.startswith(stops) for name in studio.state("reach")["limits"])
    studio.page.click("#mode-plan")
    studio.page.click("#view-free")


def test_studio_draws_a_still_posture_once_at_high_resolution_and_motion_at_low_resolution(studio: Studio):
    share = "(c => c.width / c.clientWidth)(document.querySelector('#canvas'))"
    studio.write(WORDS)
    studio.page.click("#mode-plan")
    studio.page.until(f"Math.abs({share} - 2) < 0.01")
    drawn = studio.state("drawn")
    for _ in range(3):
        studio.page.click("#mode-plan")
    turned = "(s => s.show({...s.shown, angles: s.shown.angles.map(angle => angle + %s)}))(kinesicStudio.view.stage)"
    for _ in range(3):
        studio.page.value(turned % 0.001)  # below a tick of an encoder, which is invisible
    studio.rest(0.1)
    assert studio.state("drawn") == drawn
    studio.page.value("document.querySelector('#show-sectors').click()")  # without a pointer, as by keyboard
    studio.page.until("!document.querySelector('#sectors').hasAttribute('hidden')")
    studio.page.value("document.querySelector('#show-sectors').click()")
    studio.page.until("document.querySelector('#sectors').hasAttribute('hidden')")
    drawn = studio.state("drawn")
    studio.page.value(turned % 0.01)
    studio.until(f"s.drawn > {drawn}")
    sketched = "!document.querySelector('#sketch').hidden"
    studio.page.until(f"!({sketched})")
    studio.page.click("#play")
    studio.page.until(sketched)
    assert studio.page.value("getComputedStyle(document.querySelector('#canvas')).opacity") == "0"
    studio.page.click("#play")
    studio.page.until(f"!({sketched}) && Math.abs({share} - 2) < 0.01")
    asked = "{...s.shown, angles: s.shown.angles.map(angle => angle + 0.01), asked: performance.now()}"
    shows = f"const drawn = s.drawn; s.busy = true; s.show({asked}); s.busy = false; return s.drawn - drawn"
    assert studio.page.value(f"(s => {{ {shows} }})(kinesicStudio.view.stage)") == 1, "it waits for no fine frame"


SKETCHED = """(() => {
  const { scene, sketch, size, look, shown, ink, gl } = kinesicStudio.view.stage;
  const pixels = size.width * size.height, away = (a, b) => Math.max(...[0, 1, 2].map(k => Math.abs(a[k] - b[k])));
  const found = [];
  for (const ghost of [undefined, shown.angles.map(angle => angle + 0.15)]) {
    const lit = new Set([kinesicStudio.about.robot.names.length - 1]);
    const strain = shown.angles.map((_, k) => k % 2);
    const picture = { look, twin: { angles: shown.angles, duty: strain }, ghost, beside: false, ink, lit };
    sketch.draw(picture, { ...scene.camera(look, size), frames: scene.frames(shown.angles) }, size, 1);
    scene.draw({ ...picture, scale: 1, full: false });
    const exact = new Uint8Array(4 * pixels);
    gl.readPixels(0, 0, size.width, size.height, gl.RGBA, gl.UNSIGNED_BYTE, exact);
    const quick = new Uint8Array(sketch.raster.pixels.buffer);
    let body = 0, both = 0, alike = 0, floor = 0;
    for (let y = 0; y < size.height; y++) for (let x = 0; x < size.width; x++) {
      const [i, j] = [4 * ((size.height - 1 - y) * size.width + x), 4 * (y * size.width + x)];
      const [a, b] = [exact.slice(i, i + 4), quick.slice(j, j + 4)];
      if (a[3] > 90 || b[3] > 90) {
        body += 1;
        both += Math.abs(a[3] - b[3]) < 8;
        alike += a[3] === 255 && b[3] === 255 && away(a, b) < 40;
      } else floor = Math.max(floor, Math.abs(a[3] - b[3]));
    }
    found.push([both / body, alike / body, floor]);
  }
  sketch.hide();
  return found;
})()"""


def test_robot_drawn_by_the_studio_without_webgl_looks_like_the_webgl_drawing(studio: Studio):
    """Compare silhouettes, lit colours, highlights, strain, floor and ghost."""
    studio.write(WORDS)
    studio.page.click("#mode-plan")
    studio.page.until("kinesicStudio.view.stage.sketch !== null")
    (both, alike, floor), (both_with_ghost, _, floor_with_ghost) = studio.page.value(SKETCHED)
    assert min(both, both_with_ghost) > 0.9
    assert alike > 0.75
    assert max(floor, floor_with_ghost) < 16


def test_drag_in_the_studio_sends_at_most_50_reach_requests_per_second(studio: Studio):
    """Expect at most one request per read cycle of the server."""
    studio.write(WORDS)
    studio.page.click("#mode-plan")
    studio.until("s.left !== null")
    hand, seconds = studio.state("left"), 0.6
    studio.page.call("Input.dispatchMouseEvent", type="mousePressed", **hand, button="left", buttons=1, clickCount=1)
    move = f"new PointerEvent('pointerrawupdate', {{clientX: {hand['x']} + k % 20, clientY: {hand['y']} - k % 30}})"
    counted = studio.page.value(
        "(wire => { let asked = 0, k = 0; const ask = wire.ask.bind(wire), stage = document.querySelector('#canvas');"
        "wire.ask = (verb, values) => { asked += verb === 'reach'; return ask(verb, values); };"
        f"const moves = setInterval(() => stage.dispatchEvent({move}, ++k), 4);"
        "return new Promise(done => setTimeout(() => { clearInterval(moves); delete wire.ask; done(asked); }, "
        f"{1000 * seconds})); }})(kinesicStudio.robot.wire)"
    )
    studio.page.call("Input.dispatchMouseEvent", type="mouseReleased", **hand, button="left")
    assert 2 < counted <= 50 * seconds + 1
    studio.page.click("#mode-plan")


@pytest.mark.soak
def test_studio_page_benchmark_measures_edit_and_drag_latency_and_first_paint(studio: Studio):
    metrics = time_page(browser(), f"http://localhost:{studio.server.port}/", loads=1, seconds=0.5)
    assert [metric.name for metric in metrics] == list(PAGE_GOALS)
    edit, drag, paint, robot = (metric.value or 0.0 for metric in metrics)
    assert edit > 1.0
    assert drag > 1.0
    assert robot > paint > 1.0


def test_studio_shows_a_lost_server_connection_during_a_drag_until_it_returns(studio: Studio):
    way = ExitStack()
    door = way.enter_context(relay(studio.server.port, studio.files))
    with way, opened(f"http://{door}/", drawn=False) as page:
        there = Studio(page, studio.server, studio.folder)
        page.until("window.kinesicStudio !== undefined && kinesicStudio.state().planned > 0")
        page.value("faults = [], onerror = onunhandledrejection = fault => faults.push(String(fault)), 0")
        there.until("s.connection === 'open' && s.left !== null")
        hand = there.state("left")
        mouse = partial(page.call, "Input.dispatchMouseEvent", x=hand["x"], button="left", buttons=1, clickCount=1)
        mouse(type="mousePressed", y=hand["y"])
        mouse(type="mouseMoved", y=hand["y"] - 9)
        there.until("s.reach !== null")
        way.close()
        mouse(type="mouseMoved", y=hand["y"] - 12)
        there.until("s.connection === 'closed'")
        assert page.value("document.querySelector('#state').textContent") == "no server"
        assert page.value("document.querySelector('#stop').disabled")
        mouse(type="mouseMoved", y=hand["y"] - 15)
        with relay(studio.server.port, studio.files, door.port):
            there.until("s.connection === 'open' && !document.querySelector('#stop').disabled")
            before = there.state("latencies.length")
            mouse(type="mouseMoved", y=hand["y"] - 25)
            there.until(f"s.latencies.length > {before} && s.reach.reached")
            mouse(type="mouseReleased", y=hand["y"] - 25)
            assert page.value("faults") == []
