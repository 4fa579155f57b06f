// Opens documents: templates, examples, files of the folder, earlier versions, and backups of unsaved documents.
import { Backups, type Unsaved } from "./backups.ts";
import { Documents, type Stored } from "./documents.ts";
import { fillOpenMenu } from "./open_menu.ts";
import { type Earlier, Recovery, rememberAtEnd, takeEarlier } from "./recovery.ts";
import { Saving } from "./saving.ts";
import type { About } from "./types.ts";
import type { Wire } from "./wire.ts";

/** Parts of the page that opening and saving need. */
export interface FilesListener {
  text(): string;
  /** Typed text that is not in the document yet. */
  typed(): string;
  /** Put text into the Words field again, without gestures yet. */
  retype(typed: string): void;
  /** Show another document from its beginning. */
  show(text: string): void;
  /** Change the document; can be undone. */
  edit(text: string): void;
  saved(): void;
  say(text: string): void;
}

export class Files {
  readonly saving: Saving;
  private readonly documents: Documents;
  private readonly backups: Backups;
  private readonly recovery: Recovery;
  private readonly earlier: Earlier | null = takeEarlier();
  private isFirstConnection = true;

  constructor(
    private readonly about: About,
    wire: Wire,
    private readonly listener: FilesListener,
  ) {
    const say = (text: string) => listener.say(text);
    this.backups = new Backups(wire);
    this.documents = new Documents(wire, say);
    this.saving = new Saving(this.documents, this.backups, {
      text: () => listener.text(),
      typed: () => listener.typed(),
      saved: () => {
        listener.saved();
        this.fillMenu();
      },
      say,
    });
    this.recovery = new Recovery(this.backups, (unsaved) => this.restore(unsaved), say);
    rememberAtEnd(() => ({ key: this.saving.key, file: this.saving.file }));
  }

  /** Begin with the unsaved document from before a reload, or else with the first example. */
  begin(): void {
    const unsaved = this.earlier && this.backups.readHere(this.earlier.key);
    if (unsaved) this.restore(unsaved);
    else this.openExample(this.about.examples[0]?.name ?? "");
  }

  /** Open the document that this page is for; false if it is shown already. */
  async connected(): Promise<boolean> {
    this.saving.reconnected();
    void this.recovery.offer();
    if (!this.isFirstConnection) return false;
    this.isFirstConnection = false;
    const file = this.earlier?.file ?? this.about.document;
    return file !== null && !this.saving.unsaved && (await this.openFile(file));
  }

  /** Open a document with a name that is not in the folder, or a file of the folder. */
  open(name: string, text: string, file: Stored | null = null): void {
    this.saving.leave();
    this.saving.begin(name, text, file);
    this.show(text);
  }

  /** Open an entry of the menu. */
  choose(kind: string, name: string): void {
    if (kind === "example") this.openExample(name);
    else if (kind === "template") this.openExample(name, this.about.templates);
    else if (kind === "backup") void this.recovery.open(name);
    else if (kind === "version") void this.openVersion(Number(name));
    else void this.openFile(name);
  }

  fillMenu(): void {
    void fillOpenMenu(this.documents, this.recovery, this.saving.file);
  }

  private openExample(name: string, among = this.about.examples): void {
    const example = among.find((each) => each.name === name);
    this.open(`${example?.name ?? "untitled"}.bml`, example?.text ?? "");
  }

  private async openFile(name: string): Promise<boolean> {
    const file = await this.documents.open(name);
    if (file) this.open(name, file.text, file);
    return file !== null;
  }

  /** Replace the text by that of an earlier version. */
  private async openVersion(number: number): Promise<void> {
    const text = await this.documents.version(this.saving.name, number);
    if (text !== null) this.listener.edit(text);
  }

  private restore(unsaved: Unsaved): void {
    this.saving.leave();
    this.saving.restore(unsaved);
    this.show(unsaved.text, unsaved.typed);
    this.listener.say(`unsaved changes of ${unsaved.name} are back`);
  }

  private show(text: string, typed = ""): void {
    this.recovery.claim(this.saving.key);
    this.listener.show(text);
    if (typed) this.listener.retype(typed);
    this.saving.changed();
  }
}
