// Finds elements of a document in its text, so that an edit touches nothing but what it changes.

export interface Attribute {
  name: string;
  value: string;
  /** Of the whole attribute with the blanks before it. */
  from: number;
  /** Of the value, between its quotes. */
  begin: number;
  end: number;
}

export interface Tag {
  name: string;
  attributes: Attribute[];
  from: number;
  /** Behind the `>`. */
  to: number;
  closing: boolean;
  empty: boolean;
}

const SKIPPED = /<!--[\s\S]*?(?:-->|$)|<!\[CDATA\[[\s\S]*?(?:\]\]>|$)|<\?[\s\S]*?(?:\?>|$)|<![^>]*(?:>|$)/y;
const TAG = /<(\/?)([A-Za-z_][\w:.-]*)((?:\s+[\w:.-]+\s*=\s*(?:"[^"]*"|'[^']*'))*)\s*(\/?)>/y;
const ATTRIBUTE = /(\s+)([\w:.-]+)(\s*=\s*)(?:"([^"]*)"|'([^']*)')/g;

/** All tags of a text in order; what is no tag, and comments, are passed over. */
export function tagsOf(text: string): Tag[] {
  const found: Tag[] = [];
  let at = text.indexOf("<");
  while (at >= 0) {
    SKIPPED.lastIndex = TAG.lastIndex = at;
    const skipped = SKIPPED.exec(text);
    const match = skipped ? null : TAG.exec(text);
    if (match) found.push(tagOf(match, at));
    const length = (skipped ?? match)?.[0].length ?? 1;
    at = text.indexOf("<", at + length);
  }
  return found;
}

function tagOf(match: RegExpExecArray, at: number): Tag {
  const [whole, slash, name, attributes, end] = match;
  const first = at + 1 + slash!.length + name!.length;
  return {
    name: name!.slice(name!.indexOf(":") + 1),
    attributes: [...attributes!.matchAll(ATTRIBUTE)].map((each) => {
      const value = each[4] ?? each[5] ?? "";
      const from = first + each.index;
      const begin = from + each[1]!.length + each[2]!.length + each[3]!.length + 1;
      return { name: each[2]!, value: unescaped(value), from, begin, end: begin + value.length };
    }),
    from: at,
    to: at + whole!.length,
    closing: slash === "/",
    empty: end === "/",
  };
}

const MARKS: readonly string[] = ["sync", "mark", "tm"];
const ROOT = "bml"; // which may have the id of one of its behaviours
/** Stands for the block itself, where the id of a behaviour is asked for; no id has a colon. */
export const BLOCK = ":block";

/** Whether a tag is a mark in what is said; marks and behaviours may have the same ids. */
export const isMark = (tag: Tag): boolean => MARKS.includes(tag.name);

/** The opening tag of the behaviour with this id; undefined where there is none. */
export function tagWithId(text: string, id: string): Tag | undefined {
  return tagsOf(text).find((tag) => (id === BLOCK ? !tag.closing && tag.name === ROOT : opens(tag, id)));
}

/** Whether a behaviour with this id begins with a tag. */
export const opens = (tag: Tag, id: string): boolean =>
  !tag.closing &&
  !isMark(tag) &&
  tag.name !== ROOT &&
  tag.attributes.some((each) => each.name === "id" && each.value === id);

export function attributeOf(tag: Tag, name: string): Attribute | undefined {
  return tag.attributes.find((each) => each.name === name || each.name.endsWith(`:${name}`));
}

const ESCAPES: Record<string, string> = { "&": "&amp;", "<": "&lt;", '"': "&quot;", "'": "&apos;" };
/** A value as it stands between quotes. */
export const escaped = (value: string) => value.replace(/[&<"']/g, (letter) => ESCAPES[letter]!);
const unescaped = (value: string) =>
  value.replace(/&(amp|lt|gt|quot|apos);/g, (whole, name) =>
    name === "gt" ? ">" : (Object.entries(ESCAPES).find(([, code]) => code === `&${name};`)?.[0] ?? whole),
  );

/** The text with an attribute of a tag set; null takes it away. */
export function withAttribute(text: string, tag: Tag, name: string, value: string | null): string {
  const old = attributeOf(tag, name);
  if (old) {
    const [from, to, middle] = value === null ? [old.from, old.end + 1, ""] : [old.begin, old.end, escaped(value)];
    return text.slice(0, from) + middle + text.slice(to);
  }
  if (value === null) return text;
  const last = tag.attributes.at(-1);
  const at = last ? last.end + 1 : tag.to - (tag.empty ? 2 : 1);
  return `${text.slice(0, at)} ${name}="${escaped(value)}"${text.slice(at)}`;
}
