// Restores unsaved documents: after a reload at once, after a crash when the person wants it.
import type { Backup, Backups, Unsaved } from "./backups.ts";
import { byId, say } from "./dom.ts";
import { formatMoment } from "./names.ts";

const SESSION = "kinesic.page"; // what this tab showed before a reload
const LOCK = "kinesic.backup."; // held by the page that edits a document

/** Document that this tab showed before a reload. */
export interface Earlier {
  key: string;
  /** Name of its file in the folder, or null. */
  file: string | null;
}

/** Take what this tab showed before a reload; a duplicate of the tab finds nothing, as both would share a backup. */
export function takeEarlier(): Earlier | null {
  try {
    const text = sessionStorage.getItem(SESSION);
    sessionStorage.removeItem(SESSION);
    return text === null ? null : (JSON.parse(text) as Earlier);
  } catch {
    return null;
  }
}

/** Remember what this tab shows, when the page ends. */
export function rememberAtEnd(present: () => Earlier): void {
  window.addEventListener("pagehide", () => {
    try {
      sessionStorage.setItem(SESSION, JSON.stringify(present()));
    } catch {
      // without storage, a reload begins with an example
    }
  });
  window.addEventListener("pageshow", (event) => event.persisted && takeEarlier());
}

/** Offers backups of pages that have ended. */
export class Recovery {
  private release: (() => void) | null = null; // of the lock of the edited document
  private offered: Backup | null = null;
  private hasOffered = false; // whether the folder's backups were considered
  private claimed = ""; // key of the document that this page edits

  constructor(
    private readonly backups: Backups,
    private readonly restore: (document: Unsaved) => void,
    private readonly say: (text: string) => void,
  ) {
    byId("recover").addEventListener("click", () => this.offered && void this.open(this.offered.key));
    byId("recover-discard").addEventListener("click", () => {
      if (this.offered) this.backups.discard(this.offered.key);
      this.hide();
    });
    byId("recover-later").addEventListener("click", () => this.hide());
  }

  /** Tell other pages that this one edits the document with a key. */
  claim(key: string): void {
    this.release?.();
    this.claimed = key;
    void navigator.locks?.request(
      LOCK + key,
      () =>
        new Promise<void>((done) => {
          this.release = done;
        }),
    );
    if (this.offered?.key === key) this.hide();
  }

  /** List the backups that no open page edits, the newest first. */
  async list(): Promise<Backup[]> {
    const locks = await navigator.locks?.query();
    const edited = new Set((locks?.held ?? []).map(({ name }) => name));
    return (await this.backups.list()).filter(({ key }) => key !== this.claimed && !edited.has(LOCK + key));
  }

  /** Offer the newest backup of a page that has ended, once the folder has listed its backups. */
  async offer(): Promise<void> {
    if (this.hasOffered) return;
    const [newest, ...others] = await this.list();
    this.hasOffered = this.backups.isFolderListed;
    if (!newest) return;
    this.offered = newest;
    const more = others.length ? ` ${others.length} more: Open …, Unsaved.` : "";
    say(byId("recovered"), `Unsaved changes of ${newest.name} are left from ${formatMoment(newest.time)}.${more}`);
    byId("recovery").hidden = false;
  }

  /** Open a backup. */
  async open(key: string): Promise<void> {
    const found = await this.backups.read(key);
    if (found) this.restore(found);
    else this.say("this backup is gone: its document was saved or discarded by another page");
    this.hide();
  }

  private hide(): void {
    this.offered = null;
    byId("recovery").hidden = true;
  }
}
