// Text mode: a plain text becomes a performance; each word shows its gesture, and offers others.

import { byId, say } from "../dom.ts";
import { remove, setKinesicAttribute } from "../edits.ts";
import { wordAt } from "../tracks/pauses.ts";
import type { About, Draft } from "../types.ts";
import type { Wire } from "../wire.ts";
import { BLOCK, findAttribute, tagWithId } from "../xml.ts";
import { AlternativesPanel, readAlternatives } from "./alternatives.ts";
import { explainHand, explainRank } from "./choice_reasons.ts";
import { describeAdditions, keepAdditions } from "./kept_additions.ts";
import { describePending, measure } from "./pending.ts";
import { describeKept, keepPicked } from "./picked_gestures.ts";
import { type Choice, choose, isWritten } from "./replacing.ts";
import { describeCounts, listSpoken, locate, type ShownGesture, type SpokenWord, spokenText } from "./spoken.ts";
import { Tabs } from "./tabs.ts";
import { WordList } from "./word_list.ts";

const NEW_NAME = "talk.bml"; // suggested name of a document for a text

/** Parts of the page that text mode needs. */
export interface TextModeListener {
  text(): string;
  edit(text: string): void;
  /** Replace the document by one that was written for a text. */
  rewrite(text: string): void;
  open(name: string, text: string): void;
  /** Whether the document has changes that are in no file. */
  changed(): boolean;
  /** The typed text that is not in the document yet has changed. */
  typed(): void;
  /** Picture of a gesture; null if there is none. */
  picture(gesture: string): Element | null;
  /** Select a behaviour, and show the posture at a time [s]. */
  select(id: string | null, time: number): void;
}

export class TextMode {
  private readonly field = byId<HTMLTextAreaElement>("plain");
  private readonly list = new WordList((index) => this.choose(index));
  private readonly panel: AlternativesPanel;
  readonly tabs = new Tabs();
  private draft: Draft | null = null;
  private words: SpokenWord[] = [];
  private chosen = -1; // index of the chosen word; -1: none
  private behaviour: string | null = null; // gesture of the chosen word that is selected in the timeline
  private isFollowing = false; // whether the word was chosen by a selection in the timeline
  private isReplaced = false; // whether the next draft shows a new choice for the word
  private isTyped = false; // whether the field differs from what the document says
  private documents = 0; // number of shown documents
  private writing: Promise<boolean> | null = null; // the running request for gestures

  constructor(
    private readonly about: About,
    private readonly wire: Wire,
    private readonly listener: TextModeListener,
  ) {
    this.panel = new AlternativesPanel({
      choose: (choice) => this.replace(choice),
      remove: () => this.replace(null),
      picture: (gesture) => this.listener.picture(gesture),
    });
    this.field.addEventListener("input", () => {
      this.isTyped = this.pending !== "";
      this.listener.typed();
      this.enable();
    });
    byId("plain-form").addEventListener("submit", (event) => {
      event.preventDefault();
      void this.make();
    });
    this.enable();
  }

  /** Text of the field that has no gestures yet; empty if all of it has them. */
  get typed(): string {
    return this.isTyped ? this.field.value : "";
  }

  private get pending(): string {
    return describePending(this.field.value, spokenText(this.words));
  }

  /** Return the selected word, or else the one at a time [s] within a speech. */
  wordAt(time: number): SpokenWord | undefined {
    return (this.isFollowing ? undefined : this.words[this.chosen]) ?? wordAt(this.words, time);
  }

  /** Show a gesture at the word that a person has chosen; false if none is chosen. */
  place(gesture: string): boolean {
    const isPlaced = this.chosen >= 0 && !this.isFollowing;
    if (isPlaced) this.replace({ id: gesture, why: "from the list of all gestures" });
    return isPlaced;
  }

  /** Choose the word of a behaviour that is selected in the timeline; null: none or several are selected. */
  follow(id: string | null): void {
    const index = this.words.findIndex(({ gestures }) => gestures.some((each) => each.id === id));
    if (index < 0 ? !this.isFollowing : index === this.chosen && this.present?.id === id) return;
    this.list.press(this.chosen, false);
    this.chosen = index;
    this.behaviour = id;
    this.isFollowing = index >= 0;
    this.list.press(index, true);
    if (this.isFollowing) void this.ask(false);
    else this.panel.hide();
  }

  /** Gesture of the chosen word that the list of alternatives shows; null if there is none. */
  private get present(): ShownGesture | null {
    const gestures = this.words[this.chosen]?.gestures ?? [];
    return gestures.find(({ id }) => id === this.behaviour) ?? gestures[0] ?? null;
  }

  /** Put text into the field again, without gestures yet. */
  retype(typed: string): void {
    this.field.value = typed;
    this.isTyped = true;
    this.enable();
  }

  /** Choose the gestures of typed text before a performance; whether nothing is left without. */
  async finish(): Promise<boolean> {
    await this.writing;
    return !this.isTyped || (await this.make());
  }

  /** Choose the gestures of typed text before saving, unless another document with changes would stay unsaved. */
  async finishToSave(): Promise<boolean> {
    if (!this.isTyped || isWritten(this.listener.text()) || !this.listener.changed()) return this.finish();
    say(byId("plain-status"), "Saved without the new text: Choose gestures puts it into a document of its own.");
    return true;
  }

  /** Begin with another document; gestures under edit have no words. */
  begin(isGesture: boolean): void {
    this.documents += 1;
    this.words = [];
    this.field.value = "";
    say(byId("plain-status"), "");
    this.isTyped = false;
    [this.chosen, this.isFollowing] = [-1, false];
    this.panel.hide();
    this.list.show([], -1, false);
    say(byId("spoken-count"), "planning …"); // until the plan tells its words
    this.tabs.limit(isGesture);
  }

  /** Show the words of a draft with their gestures. */
  show(draft: Draft): void {
    this.draft = draft;
    this.words = listSpoken(this.listener.text(), draft);
    const wasTyped = this.isTyped;
    this.isTyped &&= this.pending !== "";
    if (!this.isTyped) this.field.value = spokenText(this.words);
    if (wasTyped && !this.isTyped) this.listener.typed();
    const chosen = this.words[this.chosen];
    if (this.isReplaced && chosen) this.listener.select(this.present?.id ?? null, chosen.start);
    this.isReplaced = false;
    if (this.chosen >= this.words.length) this.chosen = -1;
    this.list.show(this.words, this.chosen, isWritten(this.listener.text()));
    say(byId("spoken-count"), describeCounts(this.words));
    if (this.chosen >= 0) void this.ask(false);
    else this.panel.hide();
    this.enable();
  }

  /** Show the counts of the former words again, because a document could not be planned. */
  failed(): void {
    say(byId("spoken-count"), describeCounts(this.words));
  }

  private choose(index: number): void {
    this.list.press(this.chosen, false);
    this.chosen = this.chosen === index ? -1 : index;
    [this.behaviour, this.isFollowing] = [null, false];
    const word = this.words[this.chosen];
    if (!word) {
      this.panel.hide();
      return;
    }
    this.list.press(index, true);
    this.listener.select(this.present?.id ?? null, word.start);
    void this.ask(true);
  }

  /** Ask for the alternatives of the chosen word; a click also scrolls to them. */
  private async ask(isClicked: boolean): Promise<void> {
    const word = this.words[this.chosen];
    if (!word) return;
    const { present } = this;
    const hand = present ? this.explainHand(present) : "";
    this.panel.show(word.text, present, null, [hand]);
    const place = locate(this.words, word);
    const answer = await this.wire.ask("alternatives", { ...place, intent: present?.intent ?? "" });
    if (answer?.outdated || word !== this.words[this.chosen] || present !== this.present) return;
    const alternatives = readAlternatives(answer);
    const rank = present ? explainRank(word, present, alternatives, this.words) : "";
    this.panel.show(word.text, present, alternatives, [rank, hand]);
    if (isClicked) this.panel.reveal();
  }

  private explainHand({ id }: ShownGesture): string {
    const tag = tagWithId(this.listener.text(), id);
    return this.draft ? explainHand(id, tag && findAttribute(tag, "mode")?.value, this.draft) : "";
  }

  /** Show another gesture at the chosen word; null: none. */
  private replace(choice: Choice | null): void {
    const word = this.words[this.chosen];
    if (!word) return;
    const { present } = this;
    const text = this.listener.text();
    this.isReplaced = choice !== null;
    this.panel.markChosen(word.text, choice?.id ?? null);
    if (choice) this.listener.edit(choose(text, word, present, choice));
    else if (present) this.listener.edit(remove(text, present.id));
  }

  /** Ask for the document of the typed text, once at a time; whether the document has it. */
  private make(): Promise<boolean> {
    this.writing ??= this.write().finally(() => {
      this.writing = null;
    });
    return this.writing;
  }

  private async write(): Promise<boolean> {
    const style = findStyle(this.listener.text());
    const text = this.field.value;
    const { documents } = this;
    say(byId("plain-status"), "choosing gestures …");
    const answer = await this.wire.ask("author", { text, style });
    if (answer?.outdated || documents !== this.documents) return false; // another document was opened meanwhile
    const fault = (answer?.error as { text?: string } | undefined)?.text;
    if (!answer || fault || typeof answer.bml !== "string") {
      say(byId("plain-status"), fault ?? "no server");
      return false;
    }
    const later = this.field.value;
    this.isTyped = false; // the text moves into the document
    this.listener.typed();
    const bml = style ? setKinesicAttribute(answer.bml, BLOCK, "style", style) : answer.bml;
    const former = this.listener.text();
    const { text: merged, notes } = isWritten(former) ? this.keep(former, bml) : { text: bml, notes: [] };
    if (!isWritten(former)) this.listener.open(NEW_NAME, this.about.templates[0]?.text ?? "");
    this.chosen = -1;
    this.listener.rewrite(merged);
    say(byId("spoken-count"), "planning …"); // until the plan tells its words
    this.field.value = later;
    this.isTyped = later !== text;
    this.listener.typed();
    this.enable();
    const warnings = Array.isArray(answer.warnings) ? answer.warnings : [];
    say(byId("plain-status"), [...notes, ...warnings].join(" "));
    return true;
  }

  /** Put what a person has picked or added in the former document into another one; tell what stays. */
  private keep(former: string, bml: string): { text: string; notes: string[] } {
    const picked = keepPicked(former, this.words, bml);
    const added = keepAdditions({ text: former, words: this.words, draft: this.draft }, picked.text);
    return { text: added.text, notes: [...describeKept(picked), ...describeAdditions(added)] };
  }

  private enable(): void {
    byId<HTMLButtonElement>("plain-make").disabled = !this.field.value.trim();
    say(byId("plain-count"), measure(this.field.value));
    say(byId("plain-pending"), this.isTyped ? this.pending : "");
  }
}

/** Return the style of a whole document; empty without one. */
function findStyle(text: string): string {
  const root = tagWithId(text, BLOCK);
  return (root && findAttribute(root, "style")?.value) ?? "";
}
