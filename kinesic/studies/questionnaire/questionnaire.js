"use strict";
// Leads a participant through a study and keeps the answers until they are saved as CSV. The study's own script says
// what a participant is shown (`drawn`, `known`), shows it and asks (`present`), and what of it is kept (`rowOf`).

const study = JSON.parse(document.getElementById("study").textContent);
const found = (id) => document.getElementById(id);

function shuffled(list) {
  const all = [...list];
  for (let i = all.length - 1; i > 0; i--) {
    const j = Math.floor(Math.random() * (i + 1));
    [all[i], all[j]] = [all[j], all[i]];
  }
  return all;
}

// What other pages of the same server, or anybody at this browser, may have written is believed only if we could have.
function sound(kept) {
  const scalar = (value) => typeof value === "number" || (typeof value === "string" && value.length < 1000);
  return typeof kept?.participant === "string" && /^[0-9a-f]{1,8}$/.test(kept.participant)
    && Array.isArray(kept.order) && kept.order.length <= study.most && kept.order.every(known)
    && Number.isInteger(kept.place) && kept.place >= 0 && kept.place <= kept.order.length
    && Array.isArray(kept.rows) && kept.rows.length <= kept.place
    && kept.rows.every((row) => row !== null && typeof row === "object" && Object.values(row).every(scalar));
}

function remembered() {
  try {
    return JSON.parse(localStorage.getItem(study.name) ?? "null");
  } catch (error) {
    return null;
  }
}

// What was answered survives a reload; what was seen and not answered is passed over, for it may be seen once.
function resumed() {
  const kept = remembered();
  if (sound(kept)) return kept;
  return { participant: crypto.getRandomValues(new Uint32Array(1))[0].toString(16), order: drawn(), place: 0, rows: [] };
}

function keep() {
  localStorage.setItem(study.name, JSON.stringify(state));
}

function show(section) {
  for (const each of ["welcome", "trial", "thanks"]) found(each).hidden = each !== section;
}

function next() {
  if (state.place >= state.order.length) return finish();
  const shown = state.order[state.place];
  state.place += 1;
  keep();
  found("count").textContent = `${state.place} of ${state.order.length}`;
  found("next").disabled = true;
  found("questions").replaceChildren();
  present(shown);
}

// One question: the name of its answer, its words, the values to choose from with their captions, and how it looks.
function ask(name, words, choices, look) {
  const field = document.createElement("fieldset");
  const legend = document.createElement("legend");
  legend.textContent = words;
  const scale = document.createElement("div");
  scale.className = look;
  for (const [value, text] of choices) {
    const label = document.createElement("label");
    const choice = document.createElement("input");
    const caption = document.createElement("span");
    Object.assign(choice, { type: "radio", name, value });
    caption.textContent = text;
    label.append(choice, caption);
    scale.append(label);
  }
  field.append(legend, scale);
  found("questions").append(field);
}

function chosen() {
  return Object.fromEntries(new FormData(found("questions")));
}

function complete() {
  const fields = found("questions").querySelectorAll("fieldset").length;
  return fields > 0 && Object.keys(chosen()).length === fields;
}

let shownAt = 0;

function answered() {
  const seconds = ((performance.now() - shownAt) / 1000).toFixed(1);
  const { participant, place } = state;
  state.rows.push({ ...rowOf(state.order[place - 1]), participant, place, seconds, ...chosen() });
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

function lead() {
  found("questions").addEventListener("change", () => { found("next").disabled = !complete(); });
  found("next").addEventListener("click", () => { if (complete()) answered(); next(); });
  found("stop").addEventListener("click", finish);
  found("begin").addEventListener("click", () => { show("trial"); next(); });
  if (state.place > 0) { show("trial"); next(); }
}
