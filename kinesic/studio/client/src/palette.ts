// Palette of behaviours: head, gaze, face, posture, pointing, pause and speech are added without writing XML.

import { type Anchor, blockTime, formatTime, writeAnchor } from "./anchors.ts";
import { byId, make } from "./dom.ts";
import { type Added, append, appendGesture } from "./edits.ts";
import { escapeXml } from "./xml.ts";

/** Entry of the palette. */
interface Entry {
  label: string;
  /** Stem of the new id. */
  stem: string;
  /** Element, with the prefix of the document and the attributes that all behaviours have. */
  write(prefix: string, common: string, end: string): string;
}

const STROKE_GROUPS: readonly string[] = ["Head", "Pointing"]; // groups whose behaviours have a stroke
const DURATION = 2; // [s] of behaviours that last
const PAUSES = [0.5, 1, 2, 5] as const; // [s] durations of pauses

const plain =
  (name: string, more: string) =>
  (prefix: string, common: string): string =>
    `<${prefix}${name}${common} ${more}/>`;
const lasting =
  (name: string, more: string) =>
  (prefix: string, common: string, end: string): string =>
    `<${prefix}${name}${common} end="${end}" ${more}/>`;
const pose =
  (lexeme: string) =>
  (prefix: string, common: string, end: string): string =>
    `<${prefix}posture${common} end="${end}"><${prefix}pose part="WHOLEBODY" lexeme="${lexeme}"/></${prefix}posture>`;

/** Entries by group; values of the menu are GROUP/LABEL. */
export const PALETTE: Readonly<Record<string, readonly Entry[]>> = {
  Head: [
    { label: "nod", stem: "nod", write: plain("head", 'lexeme="NOD"') },
    { label: "shake", stem: "shake", write: plain("head", 'lexeme="SHAKE"') },
  ],
  Gaze: [
    { label: "to the listener", stem: "look", write: lasting("gaze", 'target="audience"') },
    { label: "to the left", stem: "look", write: lasting("gaze", 'target="left"') },
    { label: "to the right", stem: "look", write: lasting("gaze", 'target="right"') },
  ],
  Face: [
    { label: "smile", stem: "smile", write: lasting("faceLexeme", 'lexeme="smile" amount="0.9"') },
    { label: "raised brows", stem: "brows", write: lasting("faceLexeme", 'lexeme="RAISE_BROWS"') },
    { label: "lowered brows", stem: "brows", write: lasting("faceLexeme", 'lexeme="LOWER_BROWS"') },
  ],
  Posture: [
    { label: "leaning forward", stem: "lean", write: pose("LEANING_FORWARD") },
    { label: "leaning backward", stem: "lean", write: pose("LEANING_BACKWARD") },
  ],
  Pointing: [
    { label: "to the left", stem: "point", write: plain("pointing", 'target="left" mode="LEFT_HAND"') },
    { label: "to the right", stem: "point", write: plain("pointing", 'target="right" mode="RIGHT_HAND"') },
    { label: "to the listener", stem: "point", write: plain("pointing", 'target="audience"') },
  ],
  Pause: PAUSES.map((duration) => ({
    label: `${duration} ${duration === 1 ? "second" : "seconds"}`,
    stem: "pause",
    write: plain("wait", `duration="${duration}"`),
  })),
};

const ENTRIES = new Map<string, Entry>(
  Object.entries(PALETTE).flatMap(([group, entries]) =>
    entries.map((entry) => [`${group}/${entry.label}`, entry] as const),
  ),
);

/** Append an entry of the palette at a block time [s]; null if that is not possible. */
export const addEntry = (text: string, value: string, time: number): Added | null =>
  appendEntry(text, value, blockTime(time));

/** Append an entry at an anchor, where its stroke falls or else its start; null if that is not possible. */
function appendEntry(text: string, value: string, anchor: Anchor): Added | null {
  const entry = ENTRIES.get(value);
  if (!entry) return null;
  const point = anchor.reference !== null && STROKE_GROUPS.includes(value.split("/")[0]!) ? "stroke" : "start";
  return append(text, entry.stem, (prefix, id) =>
    entry.write(prefix, ` id="${id}" ${point}="${writeAnchor(anchor)}"`, writeAnchor(anchor, DURATION)),
  );
}

/** Append what is dropped at an anchor: KIND:VALUE of the palette or of the list of gestures. */
export function addDropped(text: string, dropped: string, anchor: Anchor): Added | null {
  const at = dropped.indexOf(":");
  const [kind, value] = [dropped.slice(0, at), dropped.slice(at + 1)];
  return kind === "gesture" ? appendGesture(text, value, anchor) : appendEntry(text, value, anchor);
}

/** Append a spoken line at a block time [s]; null without words. */
export function addSpeech(text: string, words: string, time: number): Added | null {
  if (!words.trim()) return null;
  return append(text, "s", (prefix, id) => {
    const start = time > 0 ? ` start="${formatTime(time)}"` : "";
    return `<${prefix}speech id="${id}"${start}><${prefix}text>${escapeXml(words.trim())}</${prefix}text></${prefix}speech>`;
  });
}

/** Fill the menu "Add", and call `add` with the edits of the menu and of the line to say. */
export function listenToPalette(
  add: (edit: (text: string, time: number) => Added | null) => void,
  pause: (duration: number) => boolean, // puts a pause [s] into a speech, if one is spoken
): void {
  const menu = byId<HTMLSelectElement>("add");
  for (const [group, entries] of Object.entries(PALETTE)) {
    const options = entries.map(({ label }) => make("option", { value: `${group}/${label}` }, label));
    menu.append(make("optgroup", { label: group }, ...options));
  }
  menu.addEventListener("change", () => {
    const { value } = menu;
    menu.value = "";
    const [group, label] = value.split("/");
    if (group === "Pause" && pause(Number.parseFloat(label ?? ""))) return;
    add((text, time) => addEntry(text, value, time));
  });
  const line = byId<HTMLInputElement>("line");
  byId("say-line").addEventListener("submit", (event) => {
    event.preventDefault();
    const words = line.value;
    add((text, time) => addSpeech(text, words, time));
    line.value = "";
  });
}
