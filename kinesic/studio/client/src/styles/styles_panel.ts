// Styles of the selected behaviour: choice of a style, saving an own one, and playback of each change.
import { byId, make, say } from "../dom.ts";
import { setKinesicAttribute } from "../edits.ts";
import type { Player } from "../player.ts";
import type { StageView } from "../view.ts";
import type { Wire } from "../wire.ts";
import { BLOCK, findAttribute, tagWithId } from "../xml.ts";
import { changesFor, type Numbers, showNumbers } from "./numbers.ts";
import { OwnStyles } from "./own_styles.ts";
import { Preview } from "./preview.ts";

const OWN_PREFIX = "own:"; // of menu values that are own styles

/** Parts of the page that the styles need. */
export interface StylesListener {
  /** Numbers that the sliders show now. */
  numbers(): Numbers;
  /** Show the selected behaviour again with the styles that the server has. */
  loaded(): void;
}

export class StylesPanel {
  readonly preview: Preview;
  private readonly own: OwnStyles;
  private readonly name = byId<HTMLInputElement>("style-name");
  private base = ""; // style whose other values a saved style has
  private conflict = ""; // name that the next click replaces

  constructor(
    wire: Wire,
    view: StageView,
    player: Player,
    private readonly listener: StylesListener,
  ) {
    this.preview = new Preview(view, player);
    this.own = new OwnStyles(wire);
    byId("style-form").addEventListener("submit", (event) => {
      event.preventDefault();
      void this.save();
    });
    this.name.addEventListener("input", () => this.ask(""));
  }

  async load(): Promise<void> {
    await this.own.load();
    const options = this.own.styles.filter(({ own }) => own);
    byId("saved-styles").replaceChildren(
      ...options.map(({ name }) => make("option", { value: OWN_PREFIX + name }, name)),
    );
    byId("saved-styles").hidden = options.length === 0;
    this.listener.loaded();
  }

  /** Numbers of a behaviour without its own attributes: those of its style and of the block. */
  inherited(text: string, behaviour: string): Numbers {
    const read = (id: string, name: string) => {
      const tag = tagWithId(text, id);
      return tag && findAttribute(tag, name)?.value;
    };
    const server = byId<HTMLSelectElement>("style").value;
    this.base = read(behaviour, "style") ?? read(BLOCK, "style") ?? server;
    const numbers = this.own.numbers(this.base);
    if (behaviour === BLOCK) return numbers;
    const shown = showNumbers((name) => read(BLOCK, name), numbers);
    return Object.fromEntries(Object.entries(shown).map(([name, { value }]) => [name, value]));
  }

  /** Give a behaviour a style of the menu; own styles are written as numbers, which every server understands. */
  choose(text: string, behaviour: string, value: string | null): string {
    this.preview.expect();
    if (!value?.startsWith(OWN_PREFIX)) return setKinesicAttribute(text, behaviour, "style", value);
    const numbers = this.own.numbers(value.slice(OWN_PREFIX.length));
    const plain = setKinesicAttribute(text, behaviour, "style", null);
    return changesFor(numbers, this.inherited(plain, behaviour)).reduce(
      (present, [name, number]) => setKinesicAttribute(present, behaviour, name, number),
      plain,
    );
  }

  private ask(name: string): void {
    this.conflict = name;
    say(byId("style-save"), name ? "Replace" : "Save as style");
  }

  private async save(): Promise<void> {
    const typed = this.name.value;
    const result = await this.own.save(
      typed,
      this.base,
      this.listener.numbers(),
      this.conflict === typed && typed !== "",
    );
    this.ask("why" in result && result.conflict ? typed : "");
    if ("why" in result) {
      say(byId("style-status"), result.conflict ? "A style or file of this name exists. Replace it?" : result.why);
      return;
    }
    this.name.value = "";
    say(byId("style-status"), `Saved: ${result.name}, in your folder and in the menu above.`);
    await this.load();
  }
}
