// Locates elements in the text of a document, so that an edit changes nothing else.

export interface Attribute {
  name: string;
  value: string;
  /** Range of the attribute with the blanks before it. */
  from: number;
  /** Range of the value between its quotes. */
  begin: number;
  end: number;
}

export interface Tag {
  name: string;
  /** Prefix with its colon, or empty. */
  prefix: string;
  attributes: Attribute[];
  from: number;
  /** Index after the `>`. */
  to: number;
  closing: boolean;
  empty: boolean;
}

const SKIPPED = /<!--[\s\S]*?(?:-->|$)|<!\[CDATA\[[\s\S]*?(?:\]\]>|$)|<\?[\s\S]*?(?:\?>|$)|<![^>]*(?:>|$)/y;
const TAG = /<(\/?)([A-Za-z_][\w:.-]*)((?:\s+[\w:.-]+\s*=\s*(?:"[^"]*"|'[^']*'))*)\s*(\/?)>/y;
const ATTRIBUTE = /(\s+)([\w:.-]+)(\s*=\s*)(?:"([^"]*)"|'([^']*)')/g;

let latest: { text: string; tags: readonly Tag[] } = { text: "", tags: [] }; // one edit reads its text several times

/** Return all tags of a text in order; comments and other text are skipped. */
export function findTags(text: string): readonly Tag[] {
  if (latest.text !== text) latest = { text, tags: readTags(text) };
  return latest.tags;
}

function readTags(text: string): Tag[] {
  const found: Tag[] = [];
  let at = text.indexOf("<");
  while (at >= 0) {
    SKIPPED.lastIndex = TAG.lastIndex = at;
    const skipped = SKIPPED.exec(text);
    const match = skipped ? null : TAG.exec(text);
    if (match) found.push(readTag(match, at));
    const length = (skipped ?? match)?.[0].length ?? 1;
    at = text.indexOf("<", at + length);
  }
  return found;
}

function readTag(match: RegExpExecArray, at: number): Tag {
  const [whole, slash, name, attributes, end] = match;
  const first = at + 1 + slash!.length + name!.length;
  return {
    name: name!.slice(name!.indexOf(":") + 1),
    prefix: name!.slice(0, name!.indexOf(":") + 1),
    attributes: [...attributes!.matchAll(ATTRIBUTE)].map((each) => {
      const value = each[4] ?? each[5] ?? "";
      const from = first + each.index;
      const begin = from + each[1]!.length + each[2]!.length + each[3]!.length + 1;
      return { name: each[2]!, value: unescapeXml(value), from, begin, end: begin + value.length };
    }),
    from: at,
    to: at + whole!.length,
    closing: slash === "/",
    empty: end === "/",
  };
}

const MARK_TAGS: readonly string[] = ["sync", "mark", "tm"];
const ROOT_TAG = "bml"; // its id may equal that of a behaviour
/** Stands for the whole block instead of a behaviour's id; no id contains a colon. */
export const BLOCK = ":block";

/** Whether a tag is a mark in a speech; marks and behaviours may have equal ids. */
export const isMark = (tag: Tag): boolean => MARK_TAGS.includes(tag.name);

/** Return the opening tag of the behaviour with an id, or undefined. */
export function tagWithId(text: string, id: string): Tag | undefined {
  return findTags(text).find((tag) => (id === BLOCK ? !tag.closing && tag.name === ROOT_TAG : opensBehaviour(tag, id)));
}

/** Whether a behaviour with this id starts at a tag. */
export const opensBehaviour = (tag: Tag, id: string): boolean =>
  !tag.closing &&
  !isMark(tag) &&
  tag.name !== ROOT_TAG &&
  tag.attributes.some((each) => each.name === "id" && each.value === id);

/** Return the range of a behaviour's element, or null. */
export function elementSpan(text: string, id: string): { from: number; to: number } | null {
  const tags = findTags(text);
  const first = tags.findIndex((tag) => opensBehaviour(tag, id));
  const tag = tags[first];
  if (!tag) return null;
  const last = tag.empty ? tag : tags.slice(first).find((each) => each.closing && each.name === tag.name);
  return last ? { from: tag.from, to: last.to } : null;
}

export function findAttribute(tag: Tag, name: string): Attribute | undefined {
  return tag.attributes.find((each) => each.name === name || each.name.endsWith(`:${name}`));
}

const ESCAPES: Record<string, string> = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&apos;" };
const UNWRITABLE = /[^\P{Cc}\t\n\r]|\p{Cs}|[\uFFFE\uFFFF]/gu; // characters that XML cannot have
/** Escape a value for an attribute, without characters that XML cannot have. */
export const escapeXml = (value: string) =>
  value.replace(UNWRITABLE, "").replace(/[&<>"']/g, (letter) => ESCAPES[letter]!);
/** Replace the predefined entities by their characters. */
export const unescapeXml = (value: string) =>
  value.replace(
    /&(?:amp|lt|gt|quot|apos);/g,
    (code) => Object.keys(ESCAPES).find((letter) => ESCAPES[letter] === code) ?? code,
  );

/** Set an attribute of a tag; null removes it. */
export function withAttribute(text: string, tag: Tag, name: string, value: string | null): string {
  const old = findAttribute(tag, name);
  if (old) {
    const [from, to, middle] = value === null ? [old.from, old.end + 1, ""] : [old.begin, old.end, escapeXml(value)];
    return text.slice(0, from) + middle + text.slice(to);
  }
  if (value === null) return text;
  const last = tag.attributes.at(-1);
  const at = last ? last.end + 1 : tag.to - (tag.empty ? 2 : 1);
  return `${text.slice(0, at)} ${name}="${escapeXml(value)}"${text.slice(at)}`;
}
