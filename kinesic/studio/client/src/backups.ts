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
  /** Text of the Words field without gestures yet; empty if all of it has them. */
  typed: string;
}

/** Backup in a list. */
export interface Backup {
  key: string;
  name: string;
  time: number; // [ms] Unix time
}

const PREFIX = "kinesic.backup.";
const TYPED = /\n<!-- typed, without gestures yet: (".*") -->\n$/; // comment after a document in the server's folder

/** Write typed words as a comment after a document, so that its backup stays one document. */
export function writeTyped({ text, typed }: Pick<Unsaved, "text" | "typed">): string {
  if (!typed) return text;
  const words = JSON.stringify(typed).replaceAll("-", "\\u002d"); // a comment must not contain two hyphens
  return `${text}\n<!-- typed, without gestures yet: ${words} -->\n`;
}

/** Separate a document from the typed words of its comment. */
export function readTyped(text: string): Pick<Unsaved, "text" | "typed"> {
  const found = TYPED.exec(text);
  try {
    return found
      ? { text: text.slice(0, found.index), typed: String(JSON.parse(found[1] ?? "")) }
      : { text, typed: "" };
  } catch {
    return { text, typed: "" }; // a comment of another program
  }
}

/** Return a new key of an edited document. */
export const newKey = (): string => [...crypto.getRandomValues(new Uint8Array(8))].map(byteText).join("");
const byteText = (byte: number): string => byte.toString(16).padStart(2, "0");

export class Backups {
  /** Whether the folder has listed its backups; a lost connection gives only those of the browser. */
  isFolderListed = false;
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
    const { key, name, revision } = document;
    const time = Date.now() / 1000; // of this clock, as the answer may be late and the server's clock may differ
    const answer = await this.wire.ask("backup", { key, name, revision, text: writeTyped(document), time });
    return answer?.told === "backed_up";
  }

  discard(key: string): void {
    this.storage?.removeItem(PREFIX + key);
    void this.wire.ask("backup", { key });
  }

  /** List all backups, the newest first. */
  async list(): Promise<Backup[]> {
    const answer = await this.wire.ask("backups", {});
    this.isFolderListed ||= answer?.told === "backups";
    const there = ((answer?.backups as Backup[] | undefined) ?? []).map((each) => ({
      ...each,
      time: 1000 * each.time,
    }));
    const here = Object.keys(this.storage ?? {})
      .filter((key) => key.startsWith(PREFIX))
      .flatMap((key) => this.readHere(key.slice(PREFIX.length)) ?? []);
    const all = [...here, ...there].sort((a, b) => b.time - a.time);
    return all.filter(({ key }, at) => all.findIndex((each) => each.key === key) === at);
  }

  /** Read the newer backup of a document; the browser's is old if the browser was killed before it wrote to the disk. */
  async read(key: string): Promise<Unsaved | null> {
    const here = this.readHere(key);
    const answer = await this.wire.ask("backups", { key });
    if (answer?.told !== "backup") return here;
    const there = { ...(answer as unknown as Unsaved), ...readTyped(String(answer.text)) };
    return here && here.time >= 1000 * Number(answer.time) ? here : there;
  }

  readHere(key: string): (Unsaved & Backup) | null {
    try {
      const read: unknown = JSON.parse(this.storage?.getItem(PREFIX + key) ?? "null");
      const backup = read as Unsaved & Backup;
      return [backup?.name, backup?.revision, backup?.text].every((value) => typeof value === "string")
        ? { ...backup, key, typed: typeof backup.typed === "string" ? backup.typed : "" }
        : null;
    } catch {
      return null;
    }
  }
}
