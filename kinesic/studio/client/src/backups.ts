// Backups of unsaved documents, in the browser's storage and in the server's folder. The browser writes its storage to
// the disk some seconds later, and may be cleared; the folder outlives both.
import { openStorage } from "./remembered.ts";
import type { Wire } from "./wire.ts";

/** Unsaved document. */
export interface Unsaved {
  key: string;
  name: string;
  /** Revision of the file from which it came; empty without one. */
  revision: string;
  text: string;
}

/** Backup in a list. */
export interface Backup {
  key: string;
  name: string;
  time: number; // [ms] Unix time
}

const PREFIX = "kinesic.backup.";

/** Return a new key of an edited document. */
export const newKey = (): string => [...crypto.getRandomValues(new Uint8Array(8))].map(byteText).join("");
const byteText = (byte: number): string => byte.toString(16).padStart(2, "0");

export class Backups {
  private readonly storage = openStorage();

  constructor(private readonly wire: Wire) {}

  /** Store in the browser; false if that is not possible. */
  keepHere(document: Unsaved): boolean {
    try {
      this.storage?.setItem(PREFIX + document.key, JSON.stringify({ ...document, time: Date.now() }));
      return this.storage !== null;
    } catch {
      return false; // the storage is full
    }
  }

  /** Store in the server's folder; false if that is not possible. */
  async keepThere(document: Unsaved): Promise<boolean> {
    return (await this.wire.ask("backup", { ...document }))?.told === "backed_up";
  }

  discard(key: string): void {
    this.storage?.removeItem(PREFIX + key);
    void this.wire.ask("backup", { key });
  }

  /** List all backups, the newest first. */
  async list(): Promise<Backup[]> {
    const answer = await this.wire.ask("backups", {});
    const there = ((answer?.backups as Backup[] | undefined) ?? []).map((each) => ({
      ...each,
      time: 1000 * each.time,
    }));
    const here = Object.keys(this.storage ?? {})
      .filter((key) => key.startsWith(PREFIX))
      .flatMap((key) => this.readHere(key.slice(PREFIX.length)) ?? []);
    const all = new Map([...there, ...here].map((each) => [each.key, each]));
    return [...all.values()].sort((a, b) => b.time - a.time);
  }

  /** Read a backup; the browser's is never older than the server's. */
  async read(key: string): Promise<Unsaved | null> {
    const here = this.readHere(key);
    if (here) return here;
    const answer = await this.wire.ask("backups", { key });
    return answer?.told === "backup" ? (answer as unknown as Unsaved) : null;
  }

  readHere(key: string): (Unsaved & Backup) | null {
    try {
      const read: unknown = JSON.parse(this.storage?.getItem(PREFIX + key) ?? "null");
      const backup = read as Unsaved & Backup;
      return [backup?.name, backup?.revision, backup?.text].every((value) => typeof value === "string")
        ? { ...backup, key }
        : null;
    } catch {
      return null;
    }
  }
}
