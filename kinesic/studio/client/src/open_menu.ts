// Menu "Open": examples, the folder, unsaved documents and earlier versions of the document.
import type { Documents } from "./documents.ts";
import { byId, make } from "./dom.ts";
import { formatMoment } from "./names.ts";
import type { Recovery } from "./recovery.ts";

/** Fill the groups of the menu with what there is now. */
export async function fillOpenMenu(documents: Documents, recovery: Recovery, file: string | null): Promise<void> {
  const [names, backups, versions] = await Promise.all([
    documents.list(),
    recovery.list(),
    file === null ? [] : documents.versions(file),
  ]);
  fill(
    "saved",
    names.map((name) => [`file:${name}`, name] as const),
  );
  fill(
    "unsaved",
    backups.map(({ key, name, time }) => [`backup:${key}`, `${name}, ${formatMoment(time)}`] as const),
  );
  fill(
    "versions",
    versions.map(({ number, time }) => [`version:${number}`, `until ${formatMoment(1000 * time)}`] as const),
  );
  byId<HTMLOptGroupElement>("versions").label = `Earlier versions of ${file ?? "the document"}`;
}

function fill(group: string, options: (readonly [value: string, label: string])[]): void {
  byId(group).replaceChildren(...options.map(([value, label]) => make("option", { value }, label)));
  byId(group).hidden = group !== "saved" && options.length === 0;
}
