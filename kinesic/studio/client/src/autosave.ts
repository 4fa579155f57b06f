// Writes backups while a person edits: into the browser at once, into the server's folder soon after.
import type { Backups, Unsaved } from "./backups.ts";

const BROWSER_DELAY = 200; // [ms] from a change to its backup in the browser
const FOLDER_DELAY = 500; // [ms] from a change to its backup in the server's folder

export class Autosave {
  private present: Unsaved | null = null;
  private browserTimer: ReturnType<typeof setTimeout> | null = null;
  private folderTimer: ReturnType<typeof setTimeout> | null = null;
  private isSending = false;
  private isOutdated = false; // whether the text has changed while a backup was sent

  constructor(
    private readonly backups: Backups,
    /** Called after each backup, with the document and the place in which it is safe now. */
    private readonly kept: (document: Unsaved, place: "browser" | "folder") => void,
    private readonly failed: () => void,
  ) {}

  /** Back up a changed document soon. */
  keep(document: Unsaved): void {
    this.present = document;
    this.browserTimer ??= setTimeout(() => this.writeHere(), BROWSER_DELAY);
    this.folderTimer ??= setTimeout(() => void this.writeThere(), FOLDER_DELAY);
  }

  /** Forget a document that is saved or unchanged, and discard its backups. */
  discard(key: string): void {
    this.forget();
    this.backups.discard(key);
  }

  /** Back up at once: the page may end, or turns to another document. */
  flush(): void {
    if (!this.present) return;
    if (this.browserTimer !== null) this.writeHere();
    if (this.folderTimer !== null || this.isSending) void this.backups.keepThere(this.present);
    this.forget();
  }

  /** Back up in the folder after a reconnection, because an answer may be lost. */
  reconnected(): void {
    if (this.present) void this.writeThere();
  }

  private forget(): void {
    for (const timer of [this.browserTimer, this.folderTimer]) if (timer !== null) clearTimeout(timer);
    this.browserTimer = this.folderTimer = this.present = null;
  }

  private writeHere(): void {
    this.browserTimer = null;
    if (!this.present) return;
    if (this.backups.keepHere(this.present)) this.kept(this.present, "browser");
    else this.failed();
  }

  private async writeThere(): Promise<void> {
    this.folderTimer = null;
    this.isOutdated = this.isSending;
    if (this.isSending || !this.present) return;
    this.isSending = true;
    const document = this.present;
    const isKept = await this.backups.keepThere(document);
    this.isSending = false;
    if (isKept) this.kept(document, "folder");
    if (this.isOutdated && isKept) await this.writeThere();
  }
}
