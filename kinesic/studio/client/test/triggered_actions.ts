// Actions that buttons, menus and keys of the page trigger.
import { type Actions, listen } from "../src/controls.ts";
import { load } from "./page.ts";

/** Open the page; `acts` has the names and values of the triggered actions. */
export function controlled(rests = false): { window: ReturnType<typeof load>; acts: string[] } {
  const window = load();
  const acts: string[] = [];
  const act = (name: string) => (value?: unknown) =>
    name === "rests" ? rests : void acts.push(value === undefined ? name : `${name} ${value}`);
  listen(new Proxy({}, { get: (_, name) => act(String(name)) }) as unknown as Actions);
  return { window, acts };
}
