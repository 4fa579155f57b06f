// Edits of a document: pure functions from text to text that preserve all other bytes.
import { type Anchor, blockTime, formatTime, writeAnchor } from "./anchors.ts";
import { unusedId } from "./ids.ts";
import { withKinesicPrefix } from "./namespaces.ts";
import {
  elementSpan,
  escapeXml,
  findAttribute,
  findTags,
  isMark,
  opensBehaviour,
  tagWithId,
  withAttribute,
} from "./xml.ts";

/** Sync points in chronological order. */
export const POINTS = ["start", "ready", "strokeStart", "attackPeak", "stroke", "strokeEnd", "relax", "end"] as const;
/** Points of which one alone places a behaviour. */
export const PINNING: readonly string[] = ["start", "ready", "strokeStart", "attackPeak", "stroke", "strokeEnd"];

const WORD_OR_MARKUP = /<!--[\s\S]*?-->|<!\[CDATA\[[\s\S]*?\]\]>|<\?[\s\S]*?\?>|<[^>]*>|[^\s<]+/g;

type Place = { speech: string; mark: string } | { time: number };

/** Tie a sync point to a mark of a speech or to a block time [s]; remove other pinned points. */
export function tie(text: string, behaviour: string, point: string, place: Place): string {
  const value = "time" in place ? formatTime(Math.max(0, place.time)) : `${place.speech}:${place.mark}`;
  return pin(text, behaviour, point, value);
}

/** Shift a sync point from its requested block time [s] by some seconds and keep its reference. */
export function shift(text: string, behaviour: string, point: string, by: number, asked: number): string {
  const tag = tagWithId(text, behaviour);
  const old = tag && findAttribute(tag, point)?.value;
  const parts = old?.match(/^\s*([A-Za-z_][^\s+]*?)\s*([+-]\s*[\d.]+)?\s*$/);
  if (!parts) return tie(text, behaviour, point, { time: asked + by });
  const offset = Math.round((Number((parts[2] ?? "0").replace(/\s/g, "")) + by) * 1000) / 1000;
  const sign = offset > 0 ? "+" : "";
  return pin(text, behaviour, point, `${parts[1]}${offset === 0 ? "" : sign + formatTime(offset)}`);
}

function pin(text: string, behaviour: string, point: string, value: string): string {
  const others = PINNING.includes(point) ? PINNING.filter((name) => name !== point) : [];
  return [...others.map((name) => [name, null] as const), [point, value] as const].reduce(
    (present, [name, to]) => setAttribute(present, behaviour, name, to),
    text,
  );
}

/** Set an attribute of a behaviour; null removes it. */
export function setAttribute(text: string, behaviour: string, name: string, value: string | null): string {
  const tag = tagWithId(text, behaviour);
  return tag ? withAttribute(text, tag, name, value) : text;
}

/** Set an attribute of a behaviour in kinesic's namespace, which is declared if needed; null removes it. */
export function setKinesicAttribute(
  text: string,
  behaviour: string,
  name: string,
  value: string | number | null,
): string {
  const tag = tagWithId(text, behaviour);
  const written = typeof value === "number" ? formatTime(value) : value;
  const present = tag && findAttribute(tag, name)?.name;
  if (!tag || written === null || (present && !present.startsWith("kinesic")))
    return setAttribute(text, behaviour, present ?? name, written);
  const declared = withKinesicPrefix(text, tag);
  return setAttribute(declared.text, behaviour, present ?? `${declared.prefix}:${name}`, written);
}

/** Insert a mark before the n-th word after a mark, or after the start of a speech; return text and id. */
export function mark(text: string, speech: string, after: string, word: number): { text: string; mark: string } {
  const found = word === 0 ? null : findWord(text, speech, after, word);
  if (!found) return { text, mark: after };
  const { at, prefix } = found;
  const id = unusedId(text, "m", true);
  return { text: `${text.slice(0, at)}<${prefix}sync id="${id}"/>${text.slice(at)}`, mark: id };
}

/** Find the n-th word after a mark or the start of a speech; return its index in the text, and the speech's prefix. */
export function findWord(
  text: string,
  speech: string,
  after: string,
  word: number,
): { at: number; prefix: string } | null {
  const tags = findTags(text);
  const first = tags.findIndex((tag) => opensBehaviour(tag, speech));
  const last = tags.findIndex((tag, k) => k > first && tag.closing && tag.name === tags[first]?.name);
  const inside = tags.slice(first + 1, last < 0 ? undefined : last);
  const from = inside.findIndex((tag) => isMark(tag) && tag.attributes.some((a) => a.value === after));
  const opening = inside.findIndex((tag) => tag.name === "text" && !tag.closing);
  const begin = inside[from >= 0 ? from : opening] ?? tags[first];
  if (first < 0 || !begin || tags[first]?.empty) return null;
  const end = tags[last]?.from ?? text.length;
  const at = wordAt(text, begin.to, end, word);
  return at < 0 ? null : { at, prefix: tags[first]?.prefix ?? "" };
}

/** Return the index of the n-th word in a part of a text, or -1 if it has fewer; tags do not divide words. */
function wordAt(text: string, from: number, to: number, count: number): number {
  const tags = findTags(text).filter((tag) => tag.from >= from && tag.to <= to);
  let seen = 0;
  let isInWord = false; // whether a word goes on behind a tag
  for (const [k, begin] of [from, ...tags.map((tag) => tag.to)].entries()) {
    const part = text.slice(begin, tags[k]?.from ?? to);
    for (const word of part.matchAll(WORD_OR_MARKUP)) {
      if (word[0].startsWith("<") || (isInWord && word.index === 0)) continue;
      if (seen === count) return begin + word.index;
      seen += 1;
    }
    if (part) isInWord = !/\s$/.test(part);
  }
  return -1;
}

/** Remove a behaviour with its line. */
export function remove(text: string, behaviour: string): string {
  const span = elementSpan(text, behaviour);
  if (!span) return text;
  const blank = text.slice(0, span.from).match(/\n[ \t]*$/)?.[0].length ?? 0;
  return text.slice(0, span.from - blank) + text.slice(span.to);
}

/** Return a document that performs one gesture with some expressivity; its id is unique, as the server requires. */
export function alone(lexeme: string, expressivity: ReadonlyMap<string, number>, number: number): string {
  const bml = `<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="studio${number}"></bml>`;
  const asked = addGesture(bml, lexeme, 0);
  const id = asked.match(/<gesture id="([^"]*)"/)?.[1] ?? "";
  return [...expressivity].reduce((text, [name, value]) => setKinesicAttribute(text, id, name, value), asked);
}

/** Document with a new behaviour. */
export interface Added {
  text: string;
  id: string;
}

/** Append an element at the end of a document, with a new id; null if the text is no document. */
export function append(text: string, stem: string, write: (prefix: string, id: string) => string): Added | null {
  const end = findTags(text).findLast((tag) => tag.name === "bml" && (tag.closing || tag.empty));
  if (!end) return null;
  const id = unusedId(text, stem, false);
  const line = `  ${write(end.prefix, id)}\n`;
  if (end.closing) return { id, text: text.slice(0, end.from) + line + text.slice(end.from) };
  return { id, text: `${text.slice(0, end.to - 2).trimEnd()}>\n${line}</${end.prefix}bml>${text.slice(end.to)}` };
}

/** Append a gesture whose stroke falls on an anchor, or which starts at a block time [s]. */
export function appendGesture(text: string, lexeme: string, anchor: Anchor): Added | null {
  const stem = lexeme.toLowerCase().replace(/[^a-z0-9]+/g, "_");
  const point = anchor.reference === null ? "start" : "stroke";
  const write = (prefix: string, id: string) =>
    `<${prefix}gesture id="${id}" lexeme="${escapeXml(lexeme)}" ${point}="${writeAnchor(anchor)}"/>`;
  return append(text, /^[a-z_]/.test(stem) ? stem : `g_${stem}`, write);
}

/** Append a gesture at a block time [s]. */
export const addGesture = (text: string, lexeme: string, time: number): string =>
  appendGesture(text, lexeme, blockTime(time))?.text ?? text;
