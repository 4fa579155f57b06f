// Elements of the timeline: a block per behaviour with its phases, and handles at its sync points.
import { make } from "../dom.ts";
import { labelWords, outcomeWords, pointWords, typeWords } from "../plain_words.ts";
import type { Sync } from "../types.ts";
import type { Placed, TrackRow } from "./layout.ts";
import { edgesOf, mainPoint, phasesOf } from "./phases.ts";

const MIN_DEVIATION = 0.02; // [s] smallest shown deviation from the requested time

/** What the timeline knows while it draws. */
export interface Drawing {
  duration: number;
  selected: ReadonlySet<string>;
  percent(time: number): string;
  /** Picture of a gesture; null if there is none. */
  picture(gesture: string): Element | null;
}

/** Return the row of a track. */
export function drawTrack(row: TrackRow, drawing: Drawing, background: readonly Element[]): HTMLElement {
  const lane = make("div", { class: "lane", "data-lane": row.track }, ...background);
  lane.style.height = `calc(${row.lanes} * var(--lane))`;
  for (const item of row.items) lane.append(...drawItem(item, drawing));
  const name = make("span", { class: "name" }, row.name);
  const attributes = { "data-track": row.track, role: "group", "aria-label": row.name };
  return make("div", { class: row.items.length ? "row track" : "row track empty", ...attributes }, name, lane);
}

function drawItem(item: Placed, drawing: Drawing): HTMLElement[] {
  const { id } = item.behaviour;
  const chosen = drawing.selected.has(id);
  const parts = [drawBlock(item, drawing, chosen)];
  const main = mainPoint(item.points);
  if (item.first && main && item.behaviour.type !== "speech") {
    if (chosen && drawing.selected.size === 1)
      parts.push(
        ...edgesOf(item.points)
          .filter((edge) => edge !== main)
          .map((edge) => drawEdge(id, edge, drawing)),
      );
    parts.push(drawStroke(item, main, drawing, chosen));
    if (Math.abs(main.asked - main.planned) >= MIN_DEVIATION) parts.push(drawAsked(main, drawing));
  }
  for (const part of parts) {
    part.style.top = `calc(${item.lane} * var(--lane))`;
    part.style.height = "var(--lane)";
  }
  return parts;
}

function drawBlock(item: Placed, drawing: Drawing, chosen: boolean): HTMLElement {
  const { behaviour, from, to } = item;
  const { id, type, label, outcome } = behaviour;
  const length = to - from || 1;
  const phases = phasesOf(item.points).map((phase) => {
    const made = make("i", { class: `phase ${phase.name}-phase` });
    made.style.left = `${(100 * (phase.from - from)) / length}%`;
    made.style.width = `${(100 * (phase.to - phase.from)) / length}%`;
    return made;
  });
  const words = labelWords(type, label) || typeWords(type);
  const picture = type === "gesture" ? drawing.picture(label) : null;
  const warning = outcomeWords(behaviour);
  const about = warning && `, ${warning}`;
  const times = `${from.toFixed(2)} to ${to.toFixed(2)} s`;
  const block = make(
    "button",
    {
      type: "button",
      class: `block ${type} ${outcome}`,
      "data-behaviour": id,
      ...(item.first ? { "data-block": id } : { "data-echo": id, "aria-hidden": "true" }),
      "aria-pressed": String(chosen),
      "aria-label": `${typeWords(type)} ${labelWords(type, label)}, ${id}, ${times}${about}`,
      title: `${words} (${id}), ${times}${warning && `\n${warning}`}`,
      tabindex: item.first && chosen ? "0" : "-1",
    },
    ...phases,
    ...(picture ? [picture] : []),
    ...(type === "speech" ? [] : [make("span", { class: "label" }, words)]),
  );
  block.style.left = drawing.percent(from);
  block.style.width = drawing.percent(to - from);
  return block;
}

function slider(kind: string, sync: Sync, drawing: Drawing, more: Record<string, string>): HTMLElement {
  const made = make("button", {
    type: "button",
    class: kind,
    role: "slider",
    "aria-valuenow": sync.planned.toFixed(2),
    "aria-valuemin": "0",
    "aria-valuemax": drawing.duration.toFixed(2),
    "aria-label": `${pointWords(sync.sync)}: ${sync.behaviour}`,
    "data-behaviour": sync.behaviour,
    ...more,
  });
  made.style.left = drawing.percent(sync.planned);
  return made;
}

function drawStroke(item: Placed, main: Sync, drawing: Drawing, chosen: boolean): HTMLElement {
  const { id } = item.behaviour;
  const warning = outcomeWords(item.behaviour);
  return slider("stroke", main, drawing, {
    "data-stroke": id,
    tabindex: chosen ? "0" : "-1",
    title: `${id}, ${pointWords(main.sync)} at ${main.planned.toFixed(2)} s: drag it onto a word${warning && `\n${warning}`}`,
  });
}

function drawEdge(id: string, edge: Sync, drawing: Drawing): HTMLElement {
  return slider("edge", edge, drawing, {
    "data-edge": edge.sync,
    title: `${id}, ${pointWords(edge.sync)} at ${edge.planned.toFixed(2)} s: drag it to change the phases`,
  });
}

function drawAsked(main: Sync, drawing: Drawing): HTMLElement {
  const asked = make("i", { class: "asked", title: `requested: ${main.asked.toFixed(2)} s` });
  asked.style.left = drawing.percent(main.asked);
  return asked;
}
