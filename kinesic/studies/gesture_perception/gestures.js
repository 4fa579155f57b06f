// Plays gestures once each: first a participant says what each means, then which of two looks more natural. A speech
// study shows a motion with two speeches, one of which belongs to it, and the motions of two systems for a text.

const GAP = 600; // [ms] of an empty stage, before and between motions
const INK = [0.1, 0.1, 0.12];
const byId = new Map(study.trials.map((trial) => [trial.id, trial]));
const canvas = document.querySelector("#stage canvas");
const scene = sceneOf(canvas, study.robot);
const [ahead, left, above] = study.robot.view.from;
const look = { turn: Math.atan2(left, ahead), rise: Math.asin(above / Math.hypot(ahead, left, above)), zoom: 1 };

// Places 0 .. count - 1, each as often as any other, for so many items, in any order.
function places(items, count) {
  const ring = shuffled(Array.from({ length: count }, (_, k) => k));
  return shuffled(Array.from({ length: items }, (_, k) => ring[k % count]));
}

// Takes so many trials; what comes first in them stands in each place equally often, the others in any order.
function balanced(trials, most) {
  const taken = shuffled(trials).slice(0, most);
  const where = places(taken.length, taken[0]?.options.length ?? 1);
  return taken.map(({ id, options: [first, ...others] }, k) => {
    const options = shuffled(others);
    options.splice(where[k], 0, first);
    return { id, options };
  });
}

function drawn() {
  const of = (task) => study.trials.filter((trial) => trial.task === task);
  const conditions = [...new Set(of("comparison").map((trial) => trial.condition))];
  const compared = conditions.flatMap((name) =>
    balanced(of("comparison").filter((trial) => trial.condition === name), study.comparisons));
  const systems = [...new Set(of("mismatching").map((trial) => trial.condition))];
  const matched = systems.flatMap((name) =>
    balanced(of("mismatching").filter((trial) => trial.condition === name), study.matches));
  const pairs = [...new Set(of("realism").map((trial) => trial.condition))];
  const rated = pairs.flatMap((name) => balanced(of("realism").filter((trial) => trial.condition === name), study.realisms));
  return [...balanced(of("recognition"), study.recognitions), ...shuffled(compared), ...shuffled(matched), ...shuffled(rated)];
}

function known(item) {
  const trial = byId.get(item?.id);
  return trial !== undefined && Array.isArray(item.options) && item.options.length === trial.options.length
    && trial.options.every((option) => item.options.includes(option));
}

function rowOf({ id, options }) {
  const { task, stimulus, condition } = byId.get(id);
  return { task, stimulus, condition, options: options.join(study.separator) };
}

const wait = (span) => new Promise((done) => setTimeout(done, span / study.pace));

let audio = null; // made when the participant begins, as browsers demand

// Starts a speech so that its first word comes at a time [s] of the motion; returns what stops it.
function speak(speech, begin) {
  const packed = study.sounds[speech.sound];
  if (packed === undefined || audio === null) return () => {};
  const samples = new Int16Array(bytesOf(packed.samples).buffer);
  const buffer = audio.createBuffer(1, samples.length, packed.rate);
  buffer.copyToChannel(Float32Array.from(samples, (sample) => sample / 32768), 0);
  const source = new AudioBufferSourceNode(audio, { buffer });
  source.connect(audio.destination);
  const delay = begin - speech.begin;
  source.start(audio.currentTime + Math.max(delay, 0), Math.max(-delay, 0));
  return () => source.stop();
}

// Plays a motion up to a time [s], with a speech if there is one: its own or that of another motion.
function play({ angles, ...motion }, { until = motion.end, words = motion.words, shift = 0, start = () => () => {} } = {}) {
  const rows = new Int16Array(bytesOf(angles).buffer);
  const stop = start();
  return new Promise((done) => {
    const began = performance.now();
    const tick = (now) => {
      const time = (study.pace * (now - began)) / 1000;
      scene.draw({ look, twin: { angles: rowAt(motion, rows, motion.step, time) }, beside: false, ink: INK });
      const said = words.filter(([begin, end]) => begin + shift <= time && time < end + shift);
      found("words").textContent = said.map((each) => each[2]).join(" ");
      if (time < until) requestAnimationFrame(tick);
      else {
        stop();
        found("words").textContent = "";
        done();
      }
    };
    requestAnimationFrame(tick);
  });
}

// How a motion is played with the speech of an option.
function heard(trial, motion, option) {
  const speech = study.speeches[trial.speeches[option]];
  const { begin } = study.speeches[motion];
  return {
    until: trial.until,
    words: study.motions[trial.speeches[option]].words,
    shift: begin - speech.begin,
    start: () => speak(speech, begin),
  };
}

function listen() {
  audio ??= "AudioContext" in window ? new AudioContext() : null;
  audio?.resume();
}

async function present({ id, options }) {
  const trial = byId.get(id);
  const matching = trial.task === "mismatching";
  const comparing = trial.task !== "recognition";
  const motions = comparing ? options.map((side) => trial.motions[side]) : [trial.motions[trial.stimulus]];
  found("stage").style.display = "";
  for (const [k, motion] of motions.entries()) {
    canvas.style.visibility = "hidden";
    if (comparing) found("count").textContent = `${state.place} of ${state.order.length}: the ${["first", "second"][k]}`;
    await wait(GAP);
    canvas.style.visibility = "visible";
    await play(study.motions[motion], matching ? heard(trial, motion, options[k]) : trial.task === "realism" ? { words: [] } : {});
  }
  found("stage").style.display = "none"; // the questions take its place
  shownAt = performance.now();
  if (matching) ask("chosen", "Which speech belongs to the motion?", options.map((side, k) => [side, ["the first", "the second"][k]]), "pair");
  else if (comparing) ask("chosen", "Which looked more natural?", options.map((side, k) => [side, ["the first", "the second"][k]]), "pair");
  else ask("chosen", "What did the robot mean?", options.map((gesture) => [gesture, study.meanings[gesture]]), "list");
}

const state = resumed();
found("begin").disabled = scene === null;
if (study.sounds?.length) {
  found("begin").addEventListener("click", listen);
  found("next").addEventListener("click", listen);
  found("test").addEventListener("click", () => {
    listen();
    speak(study.speeches.find((speech) => speech.sound >= 0), 0);
  });
}
found("unable").hidden = scene !== null;
if (scene) lead();
