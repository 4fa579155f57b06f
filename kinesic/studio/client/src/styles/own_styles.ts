// Styles of the server, and saving an own style into the server's folder.
import { fileName } from "../names.ts";
import type { Wire } from "../wire.ts";
import { NAMES, NEUTRAL, type Numbers, readStyles, type Style, withNumbers } from "./numbers.ts";

const HEADING = "# Style saved by the studio; use it with: kinesic perform my.bml --style"; // first line of a new file

/** Result of saving: the name of the style, or why not. */
export type Saved = { name: string } | { why: string; conflict: boolean };

export class OwnStyles {
  styles: readonly Style[] = [];

  constructor(private readonly wire: Wire) {}

  async load(): Promise<void> {
    const styles = readStyles(await this.wire.ask("styles", {}));
    if (styles.length) this.styles = styles;
  }

  find(name: string): Style | undefined {
    return this.styles.find((style) => style.name === name);
  }

  numbers(name: string): Numbers {
    return this.find(name)?.numbers ?? NEUTRAL;
  }

  /** Save numbers as a style that is otherwise like another one; an existing file is replaced only if `replaces`. */
  async save(typed: string, base: string, numbers: Numbers, replaces: boolean): Promise<Saved> {
    const file = fileName(typed, ".toml");
    if (!file) return { why: "type a name", conflict: false };
    if (this.styles.some(({ name, own }) => !own && `${name}.toml` === file))
      return { why: "this is the name of a built-in style", conflict: false };
    const text = withNumbers(this.find(base)?.text ?? NAMES.map((name) => `${name} = 0\n`).join(""), numbers);
    const body = text.replace(/^(?:#.*\n)+/, ""); // the first comment describes the other style
    const written = `${HEADING} ${file}\n# Made from: ${base || "neutral"}\n${body}`;
    const answer = await this.wire.ask("save", { name: file, text: written, revision: replaces ? null : "" });
    if (answer?.told !== "saved")
      return { why: String(answer?.why ?? "no server"), conflict: answer?.conflict === true };
    return { name: file.replace(/\.toml$/, "") };
  }
}
