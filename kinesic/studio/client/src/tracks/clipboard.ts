// Copied behaviours: pasted ones get new ids, and keep references only among themselves.
import { blockTime, readAnchor, writeAnchor } from "../anchors.ts";
import { append, POINTS, setAttribute } from "../edits.ts";
import { unusedId } from "../ids.ts";
import { scopeOf } from "../namespaces.ts";
import { elementSpan, findTags, tagWithId } from "../xml.ts";
import { idsIn, readPins } from "./group_edits.ts";

interface Copied {
  id: string;
  xml: string;
  /** Times [s] after the earliest start, and references among the copied behaviours. */
  pins: ReadonlyMap<string, number | string>;
  /** Namespaces by prefix, for the prefixes that the element uses. */
  namespaces: ReadonlyMap<string, string>;
}

export interface Clip {
  items: readonly Copied[];
  /** Block time [s] of the first start. */
  origin: number;
  /** Duration [s] from the first start to the last end. */
  duration: number;
}

/** Copy behaviours; `times` are the requested block times [s] of their sync points. */
export function copyAll(
  text: string,
  ids: readonly string[],
  times: ReadonlyMap<string, ReadonlyMap<string, number>>,
): Clip {
  const known = ids.flatMap((id) => [...(times.get(id)?.values() ?? [])]);
  const origin = known.length ? Math.min(...known) : 0;
  const items = ids.flatMap((id): Copied[] => {
    const span = elementSpan(text, id);
    const tag = tagWithId(text, id);
    if (!span || !tag) return [];
    const pins = [...readPins(text, id)].flatMap(([point, value]): [string, number | string][] => {
      const inside = idsIn(value);
      if (inside.length && inside.every((each) => ids.includes(each))) return [[point, value]];
      const anchor = readAnchor(value);
      const time = times.get(id)?.get(point) ?? (anchor?.reference === null ? anchor.offset : undefined);
      return time === undefined ? [] : [[point, time - origin]];
    });
    const start = times.get(id)?.get("start");
    const placed = pins.length || start === undefined ? pins : [["start", start - origin] as const];
    const xml = POINTS.reduce((bare, point) => setAttribute(bare, id, point, null), text.slice(span.from, span.to));
    const used = new Set(
      findTags(xml).flatMap((each) => [each.prefix, ...each.attributes.map((a) => prefixOf(a.name))]),
    );
    const scope = scopeOf(findTags(text), tag);
    const namespaces = new Map([...scope].filter(([prefix]) => prefix === "" || used.has(`${prefix}:`)));
    return [{ id, xml, pins: new Map(placed), namespaces }];
  });
  return { items, origin, duration: known.length ? Math.max(...known) - origin : 0 };
}

const prefixOf = (name: string): string => name.slice(0, name.indexOf(":") + 1);

/** Append copied behaviours at a block time [s]; return the text and the new ids. */
export function paste(text: string, clip: Clip, time: number): { text: string; ids: string[] } {
  const renamed = new Map<string, string>();
  for (const { id } of clip.items) {
    const taken = [...renamed.values()].map((each) => ` id="${each}"`).join("");
    renamed.set(id, unusedId(text + taken, stemOf(id), false));
  }
  const pasted = clip.items.reduce((present, item) => {
    const id = renamed.get(item.id)!;
    return append(present, id, () => written(present, item, id, renamed, time))?.text ?? present;
  }, text);
  return { text: pasted, ids: pasted === text ? [] : [...renamed.values()] };
}

const stemOf = (id: string): string => id.replace(/_?\d+$/, "") || id;

function written(text: string, item: Copied, id: string, renamed: ReadonlyMap<string, string>, time: number): string {
  const tags = findTags(text);
  const root = tags.find((tag) => !tag.closing && tag.name === "bml");
  const scope = root ? scopeOf(tags, root) : new Map<string, string>();
  const missing = [...item.namespaces].filter(([prefix, uri]) => scope.get(prefix) !== uri);
  const declared = missing.reduce((xml, [prefix, uri]) => {
    const name = prefix ? `xmlns:${prefix}` : "xmlns";
    const own = tagWithId(xml, item.id)?.attributes.some((each) => each.name === name);
    return own ? xml : setAttribute(xml, item.id, name, uri);
  }, item.xml);
  const pinned = [...item.pins].reduce((xml, [point, value]) => {
    const now = typeof value === "number" ? writeAnchor(blockTime(value), time) : rename(value, renamed);
    return setAttribute(xml, item.id, point, now);
  }, declared);
  return setAttribute(pinned, item.id, "id", id);
}

const rename = (value: string, renamed: ReadonlyMap<string, string>): string =>
  value.replace(/[^\s:+]+(?=:)/g, (id) => renamed.get(id) ?? id);
