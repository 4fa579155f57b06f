// Draws a participant's faces, shows each once, and asks what it does.

const byId = new Map(study.stimuli.map((each) => [each.id, each]));

// As many of the upper face as of the lower, as many moving as still; in any order.
function drawn() {
  const cells = new Map();
  for (const each of shuffled(study.stimuli)) {
    const cell = `${each.region} ${each.presentation}`;
    cells.set(cell, [...(cells.get(cell) ?? []), each]);
  }
  return shuffled([...cells.values()].flatMap((cell) => cell.slice(0, study.perCell))).map((each) => each.id);
}

const known = (id) => byId.has(id);
const rowOf = (id) => ({ ...byId.get(id), stimulus: id, age: /^\d{1,3}$/.test(state.age) ? state.age : "" });

function present(id) {
  const stimulus = byId.get(id);
  const picture = new Image();
  picture.alt = "a face";
  picture.onload = () => {
    found("stage").replaceChildren(picture);
    shownAt = performance.now();
    if (stimulus.presentation === "image") return askAll(stimulus);
    setTimeout(() => { picture.remove(); askAll(stimulus); }, 1000 * study.seconds);
  };
  picture.onerror = () => { found("stage").textContent = `${stimulus.file} cannot be shown`; found("next").disabled = false; };
  found("stage").replaceChildren();
  picture.src = stimulus.file;
  found("questions").dataset.stimulus = id;
}

function askAll(stimulus) {
  const opinions = ["naturalness", "realism"];
  const all = Object.entries(study.questions[stimulus.region]);
  const labels = shuffled(all.filter(([name]) => !opinions.includes(name)));
  const points = study.scale.map((words, k) => [k + 1, words]);
  for (const [name, text] of [...labels, ...all.filter(([name]) => opinions.includes(name))]) ask(name, text, points, "scale");
}

const state = resumed();
found("begin").addEventListener("click", () => { state.age = found("age").checkValidity() ? found("age").value : ""; });
lead();
