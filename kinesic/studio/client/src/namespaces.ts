// Declarations of the namespace of kinesic's attributes, such as kinesic:power.
import { findTags, type Tag, withAttribute } from "./xml.ts";

export const KINESIC_NAMESPACE = "urn:kinesic";
const DEFAULT_PREFIX = "kinesic";

/** Return the elements around a tag, the outermost first. */
function ancestorsOf(tags: readonly Tag[], tag: Tag): Tag[] {
  const open: Tag[] = [];
  for (const each of tags) {
    if (each.from >= tag.from) break;
    if (each.closing) open.pop();
    else if (!each.empty) open.push(each);
  }
  return open;
}

/** Return the namespaces that are declared at a tag by their prefixes; the default one has an empty prefix. */
export function scopeOf(tags: readonly Tag[], tag: Tag): Map<string, string> {
  const found = new Map<string, string>();
  for (const { name, value } of [...ancestorsOf(tags, tag), tag].flatMap((each) => each.attributes))
    if (name === "xmlns" || name.startsWith("xmlns:")) found.set(name.slice("xmlns:".length), value);
  return found;
}

/** Return all declared prefixes with their namespaces; null for a prefix with several. */
function declarations(tags: readonly Tag[]): Map<string, string | null> {
  const found = new Map<string, string | null>();
  for (const { name, value } of tags.flatMap((tag) => tag.attributes)) {
    if (!name.startsWith("xmlns:")) continue;
    const prefix = name.slice("xmlns:".length);
    found.set(prefix, (found.get(prefix) ?? value) === value ? value : null);
  }
  return found;
}

/** Return a prefix of kinesic's namespace for the attributes of a tag, and the text in which it is declared. */
export function withKinesicPrefix(text: string, tag: Tag): { text: string; prefix: string } {
  const tags = findTags(text);
  const declared = declarations(tags);
  const root = ancestorsOf(tags, tag)[0] ?? tag;
  const here = [...root.attributes, ...tag.attributes].find(
    ({ name, value }) =>
      name.startsWith("xmlns:") &&
      value === KINESIC_NAMESPACE &&
      declared.get(name.slice("xmlns:".length)) === KINESIC_NAMESPACE,
  );
  if (here) return { text, prefix: here.name.slice("xmlns:".length) };
  let prefix = DEFAULT_PREFIX;
  for (let number = 2; declared.has(prefix) && declared.get(prefix) !== KINESIC_NAMESPACE; number++)
    prefix = `${DEFAULT_PREFIX}${number}`;
  return { text: withAttribute(text, root, `xmlns:${prefix}`, KINESIC_NAMESPACE), prefix };
}
