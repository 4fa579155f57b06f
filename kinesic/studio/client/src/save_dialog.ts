// Dialog that asks for a file name, and before an existing file is replaced.
import { byId, make, say } from "./dom.ts";
import { fileName, type Suffix } from "./names.ts";

/** Result of saving under a name: null if it is saved, else why not, and whether another file would be replaced. */
export type Refusal = { why: string; conflict: boolean } | null;

export interface SaveRequest {
  suggested: string;
  suffix: Suffix;
  /** Names of the files in the folder. */
  names: Promise<string[]>;
  /** Save under a name; another file of this name is replaced only if `replaces`. */
  save(name: string, replaces: boolean): Promise<Refusal>;
}

export class SaveDialog {
  private readonly dialog = byId<HTMLDialogElement>("saving");
  private readonly field = byId<HTMLInputElement>("save-name");
  private readonly submit = byId<HTMLButtonElement>("save-ok");
  private request: SaveRequest | null = null;
  private replaces: string | null = null; // name of the file that the next click replaces

  constructor() {
    byId("save-form").addEventListener("submit", (event) => {
      event.preventDefault();
      void this.save();
    });
    byId("save-cancel").addEventListener("click", () => this.dialog.close());
    this.dialog.addEventListener("keydown", (event) => event.key === "Escape" && this.dialog.close());
    this.field.addEventListener("input", () => this.show(null));
  }

  /** Ask for a name, suggest one, and show a reason why the last save failed. */
  open(request: SaveRequest, refusal: Refusal = null): void {
    this.request = request;
    this.field.value = request.suggested.replace(/\.\w+$/, "");
    byId("save-names").replaceChildren();
    void request.names.then((names) => {
      const own = names.filter((name) => name.endsWith(request.suffix));
      byId("save-names").replaceChildren(...own.map((name) => make("option", { value: name.replace(/\.\w+$/, "") })));
    });
    this.show(refusal);
    if (!this.dialog.open) this.dialog.showModal();
    this.field.select();
  }

  private get name(): string | null {
    return this.request && fileName(this.field.value, this.request.suffix);
  }

  private show(refusal: Refusal): void {
    const { name } = this;
    this.replaces = refusal?.conflict ? name : null;
    say(byId("save-file"), name ? `Saved as ${name} in the folder of the studio.` : "Type a name.");
    say(byId("save-question"), this.replaces ? question(this.replaces) : (refusal?.why ?? ""));
    byId("save-question").hidden = refusal === null;
    say(this.submit, this.replaces ? "Replace" : "Save");
    this.submit.className = this.replaces ? "danger" : "primary";
    this.submit.disabled = name === null;
  }

  private async save(): Promise<void> {
    const { name, request } = this;
    if (!name || !request || this.submit.disabled) return;
    this.submit.disabled = true; // until the answer
    const refusal = await request.save(name, this.replaces === name);
    this.show(refusal);
    if (refusal === null) this.dialog.close();
  }
}

const question = (name: string): string =>
  `Another document has the name ${name}. Replace it? Its present text stays among the earlier versions.`;
