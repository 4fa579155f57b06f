// Documents in the server's folder: list, open and save.
import { byId, make } from "./dom.ts";
import type { Wire } from "./wire.ts";

export interface DocumentsListener {
  opened(name: string, text: string): void;
  saved(name: string, text: string): void;
  say(text: string): void;
}

export class Documents {
  constructor(
    private readonly wire: Wire,
    private readonly listener: DocumentsListener,
  ) {}

  async open(name: string): Promise<void> {
    const answer = await this.wire.ask("open", { name });
    if (answer?.told === "document") this.listener.opened(name, String(answer.text));
    else if (answer) this.listener.say(String(answer.why));
  }

  /** Ask for a name and save a text. */
  async save(suggested: string, text: string): Promise<void> {
    const name = prompt("Save as", suggested);
    if (name === null) return;
    const answer = await this.wire.ask("save", { name, text });
    this.listener.say(answer?.told === "saved" ? `saved: ${name}` : String(answer?.why ?? "no server"));
    if (answer?.told !== "saved") return;
    this.listener.saved(name, text);
    void this.list();
  }

  async list(): Promise<void> {
    const answer = await this.wire.ask("open", {});
    const names = (answer?.names as string[] | undefined) ?? [];
    byId("saved").replaceChildren(...names.map((name) => make("option", { value: `file:${name}` }, name)));
  }
}
