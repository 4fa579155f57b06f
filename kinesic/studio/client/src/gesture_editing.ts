// Editor of a gesture: its keys, the tried expressivity, and hands dragged into their keys.
import { toArmLengths } from "./arm_lengths.ts";
import { byId } from "./dom.ts";
import { alone } from "./edits.ts";
import { GestureList, readFound } from "./gestures.ts";
import { KeysPanel } from "./keys.ts";
import type { Drag } from "./stage.ts";
import { copyKey, formatPosition, type Hand, mirror, moveKey, type Place, removeKey, rename, setHand } from "./toml.ts";
import type { About, Fault, GestureDraft, Side } from "./types.ts";
import type { Answer, Wire } from "./wire.ts";

const SIDES: readonly Side[] = ["left", "right"];

/** Parts of the page that the gesture editor needs. */
export interface Desk {
  text(): string;
  edit(text: string): void;
  open(name: string, text: string): void;
  insert(lexeme: string): void;
  seek(time: number): void;
  say(text: string): void;
  /** Picture of a gesture; null if there is none. */
  picture(gesture: string): Element | null;
  /** Position of a hand on the stage [m]. */
  hand(side: Side): readonly number[] | null;
}

export class GestureEditing {
  /** Tried expressivity, NAME=VALUE; it is not stored in the gesture's file. */
  readonly expressivity = new Map<string, number>();
  private readonly keys: KeysPanel;
  private readonly list: GestureList;
  private draft: GestureDraft | null = null;
  private performances = 0; // number of performances of single gestures

  constructor(
    private readonly about: About,
    private readonly wire: Wire,
    private readonly desk: Desk,
  ) {
    this.keys = new KeysPanel({
      choose: (key) => this.choose(key),
      set: (key, hand, name, value) => desk.edit(setHand(desk.text(), key, hand as Hand, name, value)),
      copy: (key) => desk.edit(copyKey(desk.text(), key)),
      remove: (key) => desk.edit(removeKey(desk.text(), key)),
      capture: () => this.capture(),
      mirror: () => desk.edit(mirror(desk.text())),
    });
    this.list = new GestureList(about.gestures, {
      insert: (id) => desk.insert(id),
      edit: (id) => void this.copy(id),
      picture: (id) => desk.picture(id),
      find: async (words) => readFound(await this.wire.ask("find", { words: words.slice(0, 200) })),
    });
  }

  /** Start with another document. */
  begin(isGesture: boolean): void {
    this.keys.chosen = 0;
    this.draft = null;
    this.expressivity.clear();
    byId("keys").hidden = !isGesture;
    if (isGesture) byId("keys").parentElement?.scrollTo(0, 0);
  }

  /** Request the plan of the gesture with the tried expressivity. */
  ask(): Promise<Answer | null> {
    const set = [...this.expressivity].map(([name, value]) => `${name}=${value}`);
    return this.wire.ask("gesture", { toml: this.desk.text(), set });
  }

  /** Document that performs the gesture with the tried expressivity; each has an id of its own. */
  performed(): string {
    return this.draft ? alone(this.draft.gesture, this.expressivity, ++this.performances) : this.desk.text();
  }

  /** Draw the list of gestures again, with pictures that have been loaded. */
  redrawList(): void {
    this.list.redraw();
  }

  /** Add the saved gesture to the list of gestures. */
  saved(): void {
    if (this.draft) this.list.add({ id: this.draft.gesture, category: "own", says: "gesture in your folder" });
  }

  /** Show a draft at the time of the selected key. */
  show(draft: GestureDraft): void {
    this.draft = draft;
    this.choose(this.keys.chosen);
  }

  /** Set the hand of its key to the dropped position. */
  drop({ side, target }: Drag): void {
    const key = this.draft?.keys[this.keys.chosen];
    if (!key) return;
    const hand = "both" in key ? "both" : side;
    this.desk.edit(this.placed(this.desk.text(), hand, toArmLengths(this.about.robot, side, target)));
  }

  /** Set the hands of the key to their positions on the stage; a key for both gets the mean. */
  private capture(): void {
    const key = this.draft?.keys[this.keys.chosen];
    const seen = SIDES.map((side) => this.desk.hand(side));
    if (!key || !seen[0] || !seen[1]) return;
    const places = SIDES.map((side, k) => toArmLengths(this.about.robot, side, seen[k]!)) as [Place, Place];
    let text = this.desk.text();
    if ("both" in key) {
      const [out, up, forward] = places[0].map((value, k) => (value + places[1][k]!) / 2) as [number, number, number];
      text = this.placed(text, "both", [out, up, forward]);
    } else
      SIDES.forEach((side, k) => {
        if (side in key) text = this.placed(text, side, places[k]!);
      });
    this.desk.edit(text);
    this.desk.say(`pose ${this.keys.chosen + 1} set from the stage`);
  }

  /** Move a key to another place in their order, where it stays selected. */
  reorder(from: number, to: number): void {
    this.keys.chosen = to;
    this.desk.edit(moveKey(this.desk.text(), from, to));
  }

  private placed(text: string, hand: Hand, place: Place): string {
    return setHand(text, this.keys.chosen, hand, "at", formatPosition(place));
  }

  /** Show another key, and the posture at its time. */
  choose(key: number): void {
    if (!this.draft) return;
    this.keys.chosen = key;
    this.keys.show(this.draft);
    this.desk.seek(this.draft.times[this.keys.chosen] ?? 0);
  }

  private async copy(id: string): Promise<void> {
    const answer = await this.wire.ask("gesture", { lexeme: id });
    const text = answer?.toml;
    if (text === undefined) this.desk.say((answer?.error as Fault | undefined)?.text ?? "no server");
    else this.desk.open(`my_${id}.toml`, rename(String(text), `my_${id}`));
  }
}
