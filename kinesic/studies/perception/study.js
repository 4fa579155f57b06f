"use strict";
// Draws a participant's faces, shows each once, asks, and keeps the answers until they are saved as CSV.

const study = JSON.parse(document.getElementById("study").textContent);
const found = (id) => document.getElementById(id);
const KEPT = "kinesic-study";

function shuffled(list) {
  const all = [...list];
  for (let i = all.length - 1; i > 0; i--) {
    const j = Math.floor(Math.random() * (i + 1));
    [all[i], all[j]] = [all[j], all[i]];
  }
  return all;
}

// As many of the upper face as of the lower, as many moving as still; in any order.
function drawn() {
  const cells = new Map();
  for (const each of shuffled(study.stimuli)) {
    const cell = `${each.region} ${each.presentation}`;
    cells.set(cell, [...(cells.get(cell) ?? []), each]);
  }
  return shuffled([...cells.values()].flatMap((cell) => cell.slice(0, study.perCell)));
}

// What other pages of the same server, or anybody at this browser, may have written is believed only if we could have.
function sound(kept) {
  const scalar = (value) => typeof value === "number" || (typeof value === "string" && value.length < 100);
  return typeof kept?.participant === "string" && /^[0-9a-f]{1,8}$/.test(kept.participant)
    && Array.isArray(kept.order) && kept.order.length <= study.stimuli.length && kept.order.every((id) => byId.has(id))
    && Number.isInteger(kept.place) && kept.place >= 0 && kept.place <= kept.order.length
    && Array.isArray(kept.rows) && kept.rows.length <= kept.place
    && kept.rows.every((row) => row !== null && typeof row === "object" && Object.values(row).every(scalar));
}

function remembered() {
  try {
    return JSON.parse(localStorage.getItem(KEPT) ?? "null");
  } catch (error) {
    return null;
  }
}

// What was answered survives a reload; a face that was seen and not answered is passed over, for it may be seen once.
function resumed() {
  const kept = remembered();
  if (sound(kept)) return kept;
  return { participant: crypto.getRandomValues(new Uint32Array(1))[0].toString(16), order: drawn().map((each) => each.id), place: 0, rows: [] };
}

const byId = new Map(study.stimuli.map((each) => [each.id, each]));
const state = resumed();
let shownAt = 0;

function keep() {
  localStorage.setItem(KEPT, JSON.stringify(state));
}

function show(section) {
  for (const each of ["welcome", "trial", "thanks"]) found(each).hidden = each !== section;
}

function next() {
  if (state.place >= state.order.length) return finish();
  const stimulus = byId.get(state.order[state.place]);
  state.place += 1;
  keep();
  found("count").textContent = `${state.place} of ${state.order.length}`;
  found("next").disabled = true;
  found("questions").replaceChildren();
  const picture = new Image();
  picture.alt = "a face";
  picture.onload = () => {
    found("stage").replaceChildren(picture);
    shownAt = performance.now();
    if (stimulus.presentation === "image") return ask(stimulus);
    setTimeout(() => { picture.remove(); ask(stimulus); }, 1000 * study.seconds);
  };
  picture.onerror = () => { found("stage").textContent = `${stimulus.file} cannot be shown`; found("next").disabled = false; };
  found("stage").replaceChildren();
  picture.src = stimulus.file;
  found("questions").dataset.stimulus = stimulus.id;
}

function ask(stimulus) {
  const opinions = ["naturalness", "realism"];
  const all = Object.entries(study.questions[stimulus.region]);
  const labels = shuffled(all.filter(([name]) => !opinions.includes(name)));
  for (const [name, text] of [...labels, ...all.filter(([name]) => opinions.includes(name))]) {
    const field = document.createElement("fieldset");
    const legend = document.createElement("legend");
    legend.textContent = text;
    const scale = document.createElement("div");
    scale.className = "scale";
    study.scale.forEach((words, k) => {
      const label = document.createElement("label");
      const choice = document.createElement("input");
      const caption = document.createElement("span");
      Object.assign(choice, { type: "radio", name, value: k + 1 });
      caption.textContent = words;
      label.append(choice, caption);
      scale.append(label);
    });
    field.append(legend, scale);
    found("questions").append(field);
  }
}

function chosen() {
  return Object.fromEntries(new FormData(found("questions")));
}

function complete() {
  const fields = found("questions").querySelectorAll("fieldset").length;
  return fields > 0 && Object.keys(chosen()).length === fields;
}

function answered() {
  const stimulus = byId.get(found("questions").dataset.stimulus);
  state.rows.push({ ...stimulus, stimulus: stimulus.id, participant: state.participant, place: state.place,
    seconds: ((performance.now() - shownAt) / 1000).toFixed(1), ...chosen() });
  keep();
}

// A value that holds a separator is quoted; one that a spreadsheet would calculate is made a text.
function cell(value) {
  const text = String(value ?? "").replace(/^[=+\-@\t\r]/, "'$&");
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

function csv() {
  const lines = state.rows.map((row) => study.columns.map((name) => cell(row[name])).join(","));
  return [study.columns.join(","), ...lines].join("\r\n") + "\r\n";
}

async function finish() {
  show("thanks");
  found("answered").textContent = state.rows.length;
  found("file").href = URL.createObjectURL(new Blob([csv()], { type: "text/csv" }));
  found("file").download = `answers-${state.participant}.csv`;
  if (study.postTo === "") return;
  try {
    const sent = await fetch(study.postTo, { method: "POST", headers: { "Content-Type": "text/csv" }, body: csv() });
    found("sent").textContent = sent.ok ? "Your answers have been sent." : `Sending failed (${sent.status}); please save them.`;
  } catch (error) {
    found("sent").textContent = "Sending failed; please save your answers.";
  }
}

found("questions").addEventListener("change", () => { found("next").disabled = !complete(); });
found("next").addEventListener("click", () => { if (complete()) answered(); next(); });
found("stop").addEventListener("click", finish);
found("begin").addEventListener("click", () => { show("trial"); next(); });
if (state.place > 0) { show("trial"); next(); }
