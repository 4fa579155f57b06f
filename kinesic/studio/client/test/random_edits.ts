// Random edits of documents.
import { readdirSync, readFileSync } from "node:fs";
import { addGesture, mark, remove, setAttribute, setKinesicAttribute, shift, tie } from "../src/edits.ts";
import { addEntry, addSpeech, PALETTE } from "../src/palette.ts";
import { copyAll, paste } from "../src/tracks/clipboard.ts";
import { moveAll, moveOnto, stretch } from "../src/tracks/group_edits.ts";
import { BLOCK, findTags } from "../src/xml.ts";

export const welcome = readFileSync("../../configs/bml/welcome.bml", "utf8");
/** The welcome document and all examples. */
export const texts = [
  welcome,
  ...readdirSync("../examples").map((name) => readFileSync(`../examples/${name}`, "utf8")),
];

/** Return a generator of numbers in [0, 1). */
export function randomly(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), state | 1);
    mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296;
  };
}

const VALUES = ['a & "b"', "<'>", "]]>", "\u0000\u000b\ud800\uffff", "\u{1f600} ä", "--", ""];

const ENTRIES = Object.entries(PALETTE).flatMap(([group, all]) => all.map(({ label }) => `${group}/${label}`));

/** Return a text after a random edit. */
export function edited(text: string, random: () => number): string {
  const one = <T>(items: readonly T[]): T => items[Math.floor(random() * items.length)]!;
  const ids = findTags(text).flatMap((tag) => tag.attributes.filter((a) => a.name === "id").map((a) => a.value));
  const id = ids.length > 1 ? one(ids.slice(1)) : "none"; // not the document itself
  const time = random() * 9;
  const times = new Map([
    ["start", time],
    ["stroke", time + 1],
    ["end", time + 2],
  ]);
  const point = one(["start", "stroke", "relax", "end"]);
  const other = one(ids.length ? ids : ["none"]);
  const reference = one([null, "s:m1", `${id}:end`]);
  switch (Math.floor(random() * 15)) {
    case 0:
      return tie(text, id, "stroke", { time });
    case 1:
      return tie(text, id, "stroke", { speech: "s", mark: "m1" });
    case 2:
      return shift(text, id, random() < 0.5 ? "start" : "stroke", time - 4.5, time);
    case 3:
      return setAttribute(text, id, "lexeme", random() < 0.2 ? null : one(VALUES) + time);
    case 4:
      return remove(text, id);
    case 5:
      return addGesture(text, one(["Open_Palm", "beat", "m1", "9 lives", ...VALUES]), time);
    case 6:
      return setKinesicAttribute(text, one([id, BLOCK]), one(["power", "spatial"]), random() < 0.2 ? null : random());
    case 7:
      return setKinesicAttribute(text, id, "style", one(["shy", null, ...VALUES]));
    case 8:
      return addSpeech(text, one(VALUES), time)?.text ?? text;
    case 9:
      return moveAll(text, new Map([id, other].map((each) => [each, time])), time - 4.5);
    case 10:
      return moveOnto(text, id, point, { reference, offset: time - 4.5 }, times);
    case 11:
      return stretch(text, id, point, time - 4.5, times, "stroke");
    case 12:
      return paste(text, copyAll(text, [id, other], new Map([[id, times]])), time).text;
    case 13:
      return addEntry(text, one(ENTRIES), time)?.text ?? text;
    default:
      return mark(text, one([id, "s"]), "start", Math.floor(random() * 5)).text;
  }
}
