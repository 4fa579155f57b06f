// Files of the page with a server that a test plays.
import assert from "node:assert/strict";
import type { Window } from "happy-dom";
import { Files } from "../src/files.ts";
import type { About } from "../src/types.ts";
import { Wire } from "../src/wire.ts";
import { element, load, settle, sockets } from "./page.ts";

export const EXAMPLE = "<bml/>";
const ABOUT = { examples: [{ name: "greeting", text: EXAMPLE }], document: null } as unknown as About;

type Message = Record<string, unknown>;

/** The files of a page with a server that the test plays. */
export class Desk {
  text = "";
  typed = "";
  readonly said: string[] = [];
  readonly files: Files;
  socket = 0; // index of the connection; the stop line has another
  private waiting: Message[] = [];

  constructor(about: About = ABOUT) {
    const wire = new Wire({ state: () => {}, told: () => {}, feedback: () => {} }, null);
    this.files = new Files(about, wire, {
      text: () => this.text,
      typed: () => this.typed,
      retype: (typed) => {
        this.typed = typed;
      },
      show: (text) => {
        this.text = text;
        this.typed = "";
      },
      edit: (text) => this.edit(text),
      saved: () => {},
      say: (text) => this.said.push(text),
    });
    this.files.begin();
    sockets[0]?.open();
    this.read();
  }

  edit(text: string): void {
    this.text = text;
    this.files.saving.changed();
  }

  read(): Message[] {
    return [...this.waiting.splice(0), ...(sockets[this.socket]?.read() ?? [])];
  }

  /** Answer the next request of a kind, and return it. */
  async answer(verb: string, told: Message): Promise<Message> {
    const all = this.read();
    const request = all.find((each) => each.do === verb);
    assert.ok(request, `no ${verb} in ${JSON.stringify(all)}`);
    this.waiting = all.filter((each) => each !== request);
    sockets[this.socket]?.tell({ id: request.id, ...told });
    await settle();
    return request;
  }
}

/** Open a page; a reload keeps the storage of its tab. */
export function open(about?: About, kept: { local?: Window; session?: Window } = {}): { window: Window; desk: Desk } {
  const window = load();
  for (const [from, to] of [
    [kept.local?.localStorage, window.localStorage],
    [kept.session?.sessionStorage, window.sessionStorage],
  ] as const)
    for (let k = 0; from && k < from.length; k++) to.setItem(from.key(k) ?? "", from.getItem(from.key(k) ?? "") ?? "");
  return { window, desk: new Desk(about) };
}

/** Name of the document as the page shows it. */
export const name = () => element("file").textContent;
