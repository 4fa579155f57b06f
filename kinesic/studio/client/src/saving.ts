// The file of the document: its name, whether it has unsaved changes, their backups, and saving.
import { Autosave } from "./autosave.ts";
import { type Backups, newKey, type Unsaved } from "./backups.ts";
import type { Documents, Stored } from "./documents.ts";
import { byId, say } from "./dom.ts";
import type { Suffix } from "./names.ts";
import { type Refusal, SaveDialog } from "./save_dialog.ts";

const TITLE = "kinesic studio";
const MARK = "•"; // before the name of a document with unsaved changes

export interface SavingListener {
  text(): string;
  /** Typed text that is not in the document yet. */
  typed(): string;
  saved(): void;
  say(text: string): void;
}

export class Saving {
  name = "untitled.bml";
  /** Place in which the unsaved changes are safe, or nothing. */
  place: "" | "browser" | "folder" = "";
  /** Key of the backups of this document. */
  key = newKey();
  private revision: string | null = null; // of the file in the folder; null without one
  private savedText: string | null = null; // null after a restart from a backup
  private wasUnsaved = false;
  private readonly dialog = new SaveDialog();
  private readonly autosave: Autosave;

  constructor(
    private readonly documents: Documents,
    backups: Backups,
    private readonly listener: SavingListener,
  ) {
    this.autosave = new Autosave(
      backups,
      (document, place) => this.kept(document, place),
      () => listener.say("the browser's storage is full: unsaved changes are kept in the studio's folder only"),
    );
    window.addEventListener("beforeunload", (event) => this.unsaved && event.preventDefault());
    window.addEventListener("pagehide", () => this.autosave.flush());
  }

  /** Whether the document or typed text differs from its file, or from the example that it came from. */
  get unsaved(): boolean {
    return this.listener.typed() !== "" || this.isChanged;
  }

  /** Whether the document itself differs from its file. */
  get isChanged(): boolean {
    return this.listener.text() !== this.savedText;
  }

  /** Whether the folder has the document as it is. */
  get isStored(): boolean {
    return this.revision !== null && !this.unsaved;
  }

  /** Name of the file in the folder, or null without one. */
  get file(): string | null {
    return this.revision === null ? null : this.name;
  }

  private get suffix(): Suffix {
    return this.name.endsWith(".toml") ? ".toml" : ".bml";
  }

  /** Leave the present document; its unsaved changes stay as a backup. */
  leave(): void {
    if (this.wasUnsaved) this.listener.say(`unsaved changes of ${this.name} are kept: Open …, Unsaved`);
    this.autosave.flush();
  }

  /** Begin with an example, a new document, or a file of the folder. */
  begin(name: string, text: string, file: Stored | null): void {
    this.start(newKey(), name, file?.revision ?? null);
    this.savedText = text;
  }

  /** Begin with a backup. */
  restore(document: Unsaved): void {
    this.start(document.key, document.name, document.revision || null);
    this.savedText = null;
  }

  /** Mark and back up a changed text. */
  changed(): void {
    const { unsaved, wasUnsaved, key, name } = this;
    this.wasUnsaved = unsaved;
    const { listener } = this;
    const [text, typed] = [listener.text(), listener.typed()];
    if (unsaved) this.autosave.keep({ key, name, revision: this.revision ?? "", text, typed });
    else if (wasUnsaved) this.autosave.discard(key);
    if (unsaved !== wasUnsaved) this.place = "";
    this.show();
  }

  reconnected(): void {
    this.autosave.reconnected();
  }

  /** Save the document into its file; ask for a name if it has none, or if another name is wanted. */
  async save(asksForName: boolean): Promise<void> {
    if (asksForName || this.revision === null) return this.ask(null);
    const refusal = await this.write(this.name, this.revision);
    if (refusal) this.ask(refusal);
  }

  private ask(refusal: Refusal): void {
    this.dialog.open(
      {
        suggested: this.name,
        suffix: this.suffix,
        names: this.documents.list(),
        save: (name, replaces) => this.write(name, replaces ? null : this.revisionOf(name)),
      },
      refusal,
    );
  }

  /** Revision of the file that may be replaced without a question; empty: none. */
  private revisionOf(name: string): string {
    return name === this.name ? (this.revision ?? "") : "";
  }

  private async write(name: string, revision: string | null): Promise<Refusal> {
    const { key } = this;
    const text = this.listener.text();
    const result = await this.documents.save(name, text, revision);
    if ("why" in result) return result;
    this.listener.say(`saved: ${name}`);
    if (key !== this.key) return null; // another document was opened meanwhile
    this.name = name;
    this.revision = result.revision;
    this.savedText = text;
    this.changed();
    this.listener.saved();
    return null;
  }

  private start(key: string, name: string, revision: string | null): void {
    this.key = key;
    this.name = name;
    this.revision = revision;
    this.wasUnsaved = false;
    this.place = "";
  }

  private kept({ text, typed }: Unsaved, place: "browser" | "folder"): void {
    if (text === this.listener.text() && typed === this.listener.typed()) this.place = place;
    this.show();
  }

  private show(): void {
    const unsaved = this.wasUnsaved;
    say(byId("file"), unsaved ? `${MARK} ${this.name}` : this.name);
    byId("file").title = unsaved ? describe(this.place) : "No unsaved changes";
    document.title = `${unsaved ? `${MARK} ` : ""}${this.name} – ${TITLE}`;
  }
}

const describe = (place: string): string =>
  place ? `Unsaved changes; a backup is in the ${place}` : "Unsaved changes";
