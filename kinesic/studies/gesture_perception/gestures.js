// Plays gestures once each: first a participant says what each means, then which of two looks more natural.

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
  return [...balanced(of("recognition"), study.recognitions), ...shuffled(compared)];
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

function play({ angles, ...motion }) {
  const rows = new Int16Array(bytesOf(angles).buffer);
  return new Promise((done) => {
    const began = performance.now();
    const tick = (now) => {
      const time = (study.pace * (now - began)) / 1000;
      scene.draw({ look, twin: { angles: rowAt(motion, rows, motion.step, time) }, beside: false, ink: INK });
      found("words").textContent = motion.words.filter(([begin, end]) => begin <= time && time < end).map((said) => said[2]).join(" ");
      if (time < motion.end) requestAnimationFrame(tick);
      else {
        found("words").textContent = "";
        done();
      }
    };
    requestAnimationFrame(tick);
  });
}

async function present({ id, options }) {
  const trial = byId.get(id);
  const comparing = trial.task === "comparison";
  const motions = comparing ? options.map((side) => trial.motions[side]) : [trial.motions[trial.stimulus]];
  found("stage").style.display = "";
  for (const [k, motion] of motions.entries()) {
    canvas.style.visibility = "hidden";
    if (comparing) found("count").textContent = `${state.place} of ${state.order.length}: the ${["first", "second"][k]}`;
    await wait(GAP);
    canvas.style.visibility = "visible";
    await play(study.motions[motion]);
  }
  found("stage").style.display = "none"; // the questions take its place
  shownAt = performance.now();
  if (comparing) ask("chosen", "Which looked more natural?", options.map((side, k) => [side, ["the first", "the second"][k]]), "pair");
  else ask("chosen", "What did the robot mean?", options.map((gesture) => [gesture, study.meanings[gesture]]), "list");
}

const state = resumed();
found("begin").disabled = scene === null;
found("unable").hidden = scene !== null;
if (scene) lead();
