// The page's player: time, marks, words and hands on; what it shows is drawn by the scene.
(() => {
  const stage = document.getElementById("stage");
  const data = JSON.parse(document.getElementById("replay").textContent);
  const canvas = stage.querySelector("canvas");
  const scene = sceneOf(canvas, data);
  const part = (name) => stage.querySelector(`[data-part="${name}"]`);
  const slider = part("time");
  const playButton = part("play");
  const ghostChoice = part("ghost");
  const speedChoice = part("speed");
  const heads = [...document.querySelectorAll(".playhead")];

  // ---- the motion ---------------------------------------------------------------------------------------------

  const motions = Object.fromEntries(
    Object.entries(data.motions).map(([name, text]) => [name, new Int16Array(bytesOf(text).buffer)]),
  );
  const duties = bytesOf(data.duties);
  // the face of a robot that has a skin
  const features = data.features && {
    weights: bytesOf(data.features.weights),
    gaze: new Int16Array(bytesOf(data.features.gaze).buffer),
  };
  const filmed = document.querySelector("img.filmed.on-head"); // null: the face on the head is drawn
  const painted = plainFace();
  const face = filmed ? part("face") : painted.paper;
  const showFace = filmed
    ? filmOf(face, bytesOf(filmed.src.split(",")[1]), () => redraw())
    : (time) => paintFace(painted.pen, unitsAt(time));
  const voice = document.querySelector("audio"); // null: nothing is heard

  const intensities = bytesOf(data.face.rows);
  const unitsAt = (time) => {
    const row = rowAt(data, intensities, 1 / 255, time);
    return Object.fromEntries(data.face.units.map((unit, k) => [unit, row[k]]));
  };
  const mixed = (rows, unit, time) => rowAt(data, rows, unit, time);

  const home = () => ({
    turn: Math.atan2(data.view.from[1], data.view.from[0]),
    rise: Math.asin(data.view.from[2] / Math.hypot(...data.view.from)),
    zoom: 1,
  });
  let look = home();
  let time = 0;
  let playing = false;
  let fresh = true;
  let last = 0;
  let due = false;

  const ASTRAY = Math.PI / 180; // [rad] from which a ghost over the twin can be seen
  const strays = (angles, others) => angles.some((angle, hinge) => Math.abs(angle - others[hinge]) > ASTRAY);

  const draw = () => {
    due = false;
    const [who, place, when] = ghostChoice.value.split(" ");
    const beside = place === "beside";
    const ink = getComputedStyle(stage)
      .color.match(/[\d.]+/g)
      .slice(0, 3)
      .map((value) => value / 255);
    const shown = features && {
      weights: mixed(features.weights, data.features.weight_step, time),
      gaze: mixed(features.gaze, data.features.gaze_step, time),
    };
    const twin = {
      angles: mixed(motions.twin, data.step, time),
      duty: mixed(duties, data.duty_step, time),
      features: shown,
    };
    const wished = motions[who] && mixed(motions[who], data.step, time);
    const ghost = when && !strays(twin.angles, wished) ? undefined : wished;
    const places = scene.draw({ look, twin, ghost, beside, ink, face });
    [
      [part("twin"), "twin"],
      [part("other"), who],
    ].forEach(([label, words], k) => {
      label.textContent = beside ? words : "";
      [label.style.left, label.style.top] = places[k].map((share) => `${share}%`);
    });
  };
  const redraw = () => {
    if (scene && !due) {
      due = true;
      requestAnimationFrame(draw);
    }
  };

  // ---- time ---------------------------------------------------------------------------------------------------

  const tell = () => {
    const share = data.end ? time / data.end : 0;
    slider.value = time;
    slider.setAttribute("aria-valuetext", `${time.toFixed(2)} seconds`);
    part("clock").textContent = `${time.toFixed(2)} / ${data.end.toFixed(1)} s`;
    for (const head of heads)
      head.style.left = `${100 * (Number(head.dataset.from) + share * (head.dataset.to - head.dataset.from))}%`;
    const said = data.words
      .filter(([begin, end]) => begin <= time && time < end)
      .map((piece) => piece[2])
      .join(" ");
    part("words").textContent = said ? `\u201c${said}\u201d` : "";
    const now = new Map();
    for (const mark of data.marks) {
      const known = now.get(mark.behaviour) || { first: mark.at, last: mark.at, phase: "" };
      now.set(mark.behaviour, {
        first: Math.min(known.first, mark.at),
        last: Math.max(known.last, mark.at),
        phase: mark.at <= time ? mark.sync : known.phase,
        name: mark.name,
      });
    }
    part("now").textContent = [...now]
      .filter(([, { first, last }]) => first <= time && time <= last)
      .map(([, { name, phase }]) => `${name} (${phase})`)
      .join(", ");
    const duty = mixed(duties, data.duty_step, time);
    const worst = duty.indexOf(Math.max(...duty));
    showFace(time);
    part("load").textContent = worst < 0 ? "" : `busiest servo: ${data.hinges[worst]}, duty ${duty[worst].toFixed(2)}`;
    redraw();
  };
  const seek = (to) => {
    fresh = false;
    time = Math.min(Math.max(to, 0), data.end);
    speak();
    tell();
  };

  // While the voice is heard its clock is the replay's; before, after and without it time is that of the browser.
  const speak = () => {
    if (!voice) return;
    voice.playbackRate = Number(speedChoice.value);
    if (!playing || time >= voice.duration) {
      voice.pause();
      return;
    }
    voice.currentTime = time;
    voice.play().catch(() => voice.pause());
  };
  const passed = (now) =>
    voice && !voice.paused && !voice.ended
      ? Math.max(voice.currentTime, 0)
      : time + ((now - last) / 1000) * Number(speedChoice.value);
  const tick = (now) => {
    if (!playing) return;
    time = passed(now);
    last = now;
    if (time >= data.end) {
      time = data.end;
      play(false);
    }
    tell();
    if (playing) requestAnimationFrame(tick);
  };
  const play = (on) => {
    playing = on;
    stage.classList.toggle("playing", on);
    playButton.setAttribute("aria-label", on ? "Pause" : "Play");
    if (on && (fresh || time >= data.end)) time = 0;
    fresh = false;
    speak();
    if (!on) return;
    last = performance.now();
    requestAnimationFrame(tick);
  };

  // ---- hands on -----------------------------------------------------------------------------------------------

  slider.max = data.end;
  slider.addEventListener("input", () => seek(Number(slider.value)));
  playButton.addEventListener("click", () => play(!playing));
  ghostChoice.addEventListener("change", redraw);
  speedChoice.addEventListener("change", speak);
  if (voice) part("heard").addEventListener("change", (event) => (voice.muted = !event.target.checked));
  document.addEventListener("keydown", (event) => {
    const isControl = event.target.matches("select, button, input, textarea, summary") && event.target !== slider;
    if (event.key !== " " || isControl) return;
    event.preventDefault();
    play(!playing);
  });
  const marks = part("marks");
  for (const mark of data.marks) {
    const tick = document.createElement("i");
    tick.className = mark.kind;
    tick.title = mark.words;
    tick.style.left = `${(100 * mark.at) / (data.end || 1)}%`;
    tick.addEventListener("click", () => seek(mark.at));
    marks.append(tick);
  }
  for (const plot of document.querySelectorAll(".plot"))
    plot.addEventListener("click", (event) => {
      for (const head of plot.querySelectorAll(".playhead")) {
        const area = head.parentElement.getBoundingClientRect();
        const share = (event.clientX - area.left) / area.width;
        const from = Number(head.dataset.from);
        const to = Number(head.dataset.to);
        if (from <= share && share <= to) seek(((share - from) / (to - from)) * data.end);
      }
    });

  for (const link of document.querySelectorAll("[data-at]"))
    link.addEventListener("click", () => seek(Number(link.dataset.at)));

  const fingers = new Map();
  let pinch = 0;
  let moved = false;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, event);
    pinch = 0;
    moved = false;
  });
  for (const kind of ["pointerup", "pointercancel"])
    canvas.addEventListener(kind, (event) => {
      fingers.delete(event.pointerId);
      pinch = 0;
    });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    fingers.set(event.pointerId, event);
    if (fingers.size === 2) {
      const [a, b] = [...fingers.values()];
      const gap = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
      if (pinch) zoom(gap / pinch);
      pinch = gap;
      return;
    }
    const dx = event.clientX - before.clientX;
    const dy = event.clientY - before.clientY;
    moved ||= Math.hypot(dx, dy) > 2;
    look.turn -= 0.008 * dx;
    look.rise = Math.min(Math.max(look.rise + 0.008 * dy, -0.1), 1.5);
    redraw();
  });
  const zoom = (by) => {
    look.zoom = Math.min(Math.max(look.zoom * by, 0.5), 6);
    redraw();
  };
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!(event.ctrlKey || event.metaKey || document.activeElement === canvas)) return;
      event.preventDefault();
      zoom(Math.exp(-0.0015 * event.deltaY));
    },
    { passive: false },
  );
  canvas.addEventListener("dblclick", () => {
    look = home();
    redraw();
  });
  canvas.addEventListener("click", () => {
    if (!moved) play(!playing);
  });

  // ---- begin --------------------------------------------------------------------------------------------------

  stage.hidden = false;
  if (scene) {
    canvas.addEventListener("webglcontextrestored", redraw);
    new ResizeObserver(redraw).observe(canvas);
  } else {
    stage.classList.add("flat");
    const film = document.getElementById("film"); // null: the page has no film
    if (film) film.open = true;
  }
  const poster = data.marks.find((mark) => mark.kind.includes("stroke"));
  time = poster ? poster.at : 0;
  tell();
})();
