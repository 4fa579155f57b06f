// Numbers that the browser remembers between visits, such as sizes of panes.

const PREFIX = "kinesic.size.";

/** Return the browser's storage, or null where the browser denies it. */
export function openStorage(): Storage | null {
  try {
    return localStorage;
  } catch {
    return null;
  }
}

/** Return a remembered number within a range, or the usual one. */
export function recall(key: string, usual: number, min: number, max: number): number {
  const found = openStorage()?.getItem(PREFIX + key) ?? "";
  return found !== "" && Number.isFinite(Number(found)) ? Math.min(Math.max(Number(found), min), max) : usual;
}

/** Remember a number, if the storage is not full or denied. */
export function remember(key: string, value: number): void {
  try {
    openStorage()?.setItem(PREFIX + key, value.toFixed(3));
  } catch {
    return; // the next visit begins with the usual size
  }
}
