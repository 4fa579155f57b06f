// Edits of the times of several behaviours: pure functions from text to text that preserve all other bytes.
import { type Anchor, blockTime, formatTime, readAnchor, writeAnchor } from "../anchors.ts";
import { PINNING, POINTS, setAttribute } from "../edits.ts";
import { findAttribute, tagWithId } from "../xml.ts";

/** Return the sync attributes of a behaviour by the names of their points. */
export function readPins(text: string, id: string): Map<string, string> {
  const tag = tagWithId(text, id);
  const found = POINTS.map((point) => [point, tag && findAttribute(tag, point)?.value] as const);
  return new Map(found.filter((pin): pin is [(typeof POINTS)[number], string] => pin[1] !== undefined));
}

/** Return the ids to which a sync attribute refers. */
export const idsIn = (value: string): string[] => (readAnchor(value)?.reference ?? "").split(":").slice(0, -1);

/** Whether the times of a behaviour depend on those of others. */
export function dependsOn(text: string, id: string, others: ReadonlySet<string>): boolean {
  const seen = new Set<string>();
  const open = [id];
  for (let next = open.pop(); next !== undefined; next = open.pop()) {
    if (others.has(next)) return true;
    if (seen.has(next)) continue;
    seen.add(next);
    for (const value of readPins(text, next).values()) open.push(...idsIn(value));
  }
  return false;
}

/** Move behaviours by some seconds; those that refer to other moved ones follow them. */
export function moveAll(text: string, starts: ReadonlyMap<string, number>, by: number): string {
  const moved = new Set(starts.keys());
  return [...starts].reduce((present, [id, start]) => {
    const pins = readPins(present, id);
    if (!pins.size) return setAttribute(present, id, "start", formatTime(Math.max(0, start + by)));
    return [...pins].reduce((now, [point, value]) => {
      const anchor = readAnchor(value);
      if (!anchor || idsIn(value).some((each) => moved.has(each))) return now;
      return setAttribute(now, id, point, writeAnchor(anchor, by));
    }, present);
  }, text);
}

/** Move a whole behaviour so that a point falls on an anchor; `asked` are the requested times [s] of its points. */
export function moveOnto(
  text: string,
  id: string,
  point: string,
  anchor: Anchor,
  asked: ReadonlyMap<string, number>,
): string {
  const begin = asked.get(point) ?? 0;
  const others = [...readPins(text, id).keys()].filter((name) => name !== point);
  const leading = others.filter((name) => PINNING.includes(name));
  const replaced = leading.length === 1 && !readPins(text, id).has(point) ? leading : [];
  const kept = others.filter((name) => !replaced.includes(name));
  const cleared = replaced.reduce((present, name) => setAttribute(present, id, name, null), text);
  const placed = setAttribute(cleared, id, point, writeAnchor(anchor));
  return kept.reduce(
    (present, name) => setAttribute(present, id, name, writeAnchor(anchor, (asked.get(name) ?? begin) - begin)),
    placed,
  );
}

/** Move one point of a behaviour by some seconds; its main point stays where it is. */
export function stretch(
  text: string,
  id: string,
  point: string,
  by: number,
  asked: ReadonlyMap<string, number>,
  main: string,
): string {
  const pins = readPins(text, id);
  const own = pins.get(point);
  const fixed = [...pins].filter(([name]) => name !== point);
  const begin = asked.get(point) ?? 0;
  const kept =
    fixed.length || point === main
      ? text
      : setAttribute(text, id, main, writeAnchor(blockTime(asked.get(main) ?? begin)));
  const anchor = own === undefined ? null : readAnchor(own);
  if (anchor) return setAttribute(kept, id, point, writeAnchor(anchor, by));
  const relative = fixed
    .map(([name, value]) => ({ anchor: readAnchor(value), time: asked.get(name) }))
    .find((each) => each.anchor?.reference && each.time !== undefined);
  const value = relative
    ? writeAnchor(relative.anchor!, begin + by - relative.time!)
    : writeAnchor(blockTime(begin), by);
  return setAttribute(kept, id, point, value);
}
