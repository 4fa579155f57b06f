// Edits of a gesture file: pure functions from text to text that preserve all other bytes. Keys are expected inline,
// as `keys = [ { left = {...}, ... }, ... ]` of the first gesture.

export type Hand = "left" | "right" | "both";
export type Place = readonly [number, number, number];

interface Span {
  from: number;
  to: number;
}

/** Return the index after the bracket that closes the one at an index; strings and comments are skipped. */
function closingEnd(text: string, at: number): number {
  let depth = 0;
  for (let k = at; k < text.length; k++) {
    const letter = text[k]!;
    if (letter === '"' || letter === "'") k = stringEnd(text, k) - 1;
    else if (letter === "#") k = lineEnd(text, k);
    else if ("[{".includes(letter)) depth += 1;
    else if ("]}".includes(letter) && --depth === 0) return k + 1;
  }
  return text.length;
}

function stringEnd(text: string, at: number): number {
  const quote = text[at]!;
  for (let k = at + 1; k < text.length; k++) {
    if (quote === '"' && text[k] === "\\") k += 1;
    else if (text[k] === quote) return k + 1;
  }
  return text.length;
}

function lineEnd(text: string, at: number): number {
  const end = text.indexOf("\n", at);
  return end < 0 ? text.length : end;
}

/** Return the values between two brackets, without commas. */
function items(text: string, span: Span): Span[] {
  const found: Span[] = [];
  let from = -1;
  let to = -1;
  for (let k = span.from + 1; k < span.to - 1; k++) {
    const letter = text[k]!;
    if (letter === ",") {
      if (from >= 0) found.push({ from, to });
      from = -1;
    } else if (letter === "#") k = lineEnd(text, k);
    else if (!/\s/.test(letter)) {
      if (from < 0) from = k;
      if ("[{".includes(letter)) k = closingEnd(text, k) - 1;
      else if (letter === '"' || letter === "'") k = stringEnd(text, k) - 1;
      to = k + 1;
    }
  }
  return from >= 0 ? [...found, { from, to }] : found;
}

/** Return the inline tables of the keys; none for another notation. */
export function keySpans(text: string): Span[] {
  const list = keyList(text);
  return list ? items(text, list) : [];
}

function keyList(text: string): Span | null {
  const match = /^keys\s*=\s*(?=\[)/m.exec(text);
  if (!match) return null;
  const from = match.index + match[0].length;
  return { from, to: closingEnd(text, from) };
}

/** Return the value of a name in an inline table. */
function valueIn(text: string, table: Span, name: string): Span | null {
  for (const item of items(text, table)) {
    const match = /^([\w-]+)\s*=\s*/.exec(text.slice(item.from, item.to));
    if (match?.[1] === name) return { from: item.from + match[0].length, to: item.to };
  }
  return null;
}

/** Set a value of a hand's key; null removes it. */
export function setHand(text: string, key: number, hand: Hand, name: string, value: string | null): string {
  const own = keySpans(text)[key];
  const table = own && valueIn(text, own, hand);
  if (!table) return text;
  const old = valueIn(text, table, name);
  if (old && value !== null) return text.slice(0, old.from) + value + text.slice(old.to);
  const all = items(text, table).map((item) => text.slice(item.from, item.to));
  const kept = all.filter((item) => !new RegExp(`^${name}\\s*=`).test(item));
  const made = value === null ? kept : [...kept, `${name} = ${value}`];
  return `${text.slice(0, table.from)}{ ${made.join(", ")} }${text.slice(table.to)}`;
}

/** Format a position in arm lengths (outward, up, forward) with three decimals. */
export const formatPosition = (place: Place): string => `[${place.map((value) => decimal(value)).join(", ")}]`;

const decimal = (value: number): string => {
  const short = (Math.round(value * 1000) / 1000 + 0).toString();
  return short.includes(".") ? short : `${short}.0`;
};

/** Insert a copy of a key after it. */
export function copyKey(text: string, key: number): string {
  const own = keySpans(text)[key];
  if (!own) return text;
  const blank = text.slice(0, own.from).match(/\n[ \t]*$/)?.[0] ?? " ";
  return `${text.slice(0, own.to)},${blank}${text.slice(own.from, own.to)}${text.slice(own.to)}`;
}

/** Remove a key, except the last one. */
export function removeKey(text: string, key: number): string {
  const spans = keySpans(text);
  const own = spans[key];
  if (!own || spans.length < 2) return text;
  const after = spans[key + 1];
  const before = spans[key - 1];
  return after ? text.slice(0, own.from) + text.slice(after.from) : text.slice(0, before!.to) + text.slice(own.to);
}

/** Move a key to another place in their order. */
export function moveKey(text: string, from: number, to: number): string {
  const spans = keySpans(text);
  const keys = spans.map((span) => text.slice(span.from, span.to));
  const [moved] = keys.splice(from, 1);
  if (moved === undefined) return text;
  keys.splice(to, 0, moved);
  return spans.reduceRight((present, span, k) => present.slice(0, span.from) + keys[k] + present.slice(span.to), text);
}

/** Mirror the gesture. */
export function mirror(text: string): string {
  const other: Record<string, string> = { left: "right", right: "left" };
  const places = keySpans(text).flatMap((key) => items(text, key).map((item) => item.from));
  return places.reduceRight((present, from) => {
    const name = /^(left|right)\b/.exec(present.slice(from))?.[1];
    return name ? present.slice(0, from) + other[name] + present.slice(from + name.length) : present;
  }, text);
}

/** Change the gesture's id, so that the built-in gesture is kept. */
export const rename = (text: string, id: string): string => text.replace(/^id\s*=\s*"[^"]*"/m, `id = "${id}"`);
