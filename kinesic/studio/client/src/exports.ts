// Exports of a performance as files for download.
import { byId, make } from "./dom.ts";
import type { Fault } from "./types.ts";
import type { Wire } from "./wire.ts";

export class Exports {
  constructor(
    private readonly wire: Wire,
    private readonly say: (text: string) => void,
  ) {}

  /** Request the performance of a document in a format and download the file. */
  async keep(bml: string, format: string): Promise<void> {
    const answer = await this.wire.ask("export", { bml, format });
    const fault = answer?.error as Fault | undefined;
    if (!answer || fault) {
      this.say(fault?.text ?? "no server");
      return;
    }
    const name = String(answer.name);
    const bytes = Uint8Array.from(atob(String(answer.data)), (letter) => letter.charCodeAt(0));
    const address = URL.createObjectURL(new Blob([bytes]));
    const link = make("a", { href: address, download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
    this.say(`exported: ${name}, ${Math.ceil(bytes.length / 1000)} kB`);
  }

  /** Request the voice of a document (WAV, base64); null if nothing is spoken. */
  async voice(bml: string): Promise<string | null> {
    const answer = await this.wire.ask("export", { bml, format: "wav" });
    return typeof answer?.data === "string" ? answer.data : null;
  }

  listen(document: () => string): void {
    const menu = byId<HTMLSelectElement>("export");
    menu.addEventListener("change", () => {
      void this.keep(document(), menu.value);
      menu.value = "";
    });
  }
}
