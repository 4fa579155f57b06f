// Row of the timeline with the key poses of a gesture; a pose dragged past another one changes their order.
import { make } from "../dom.ts";

const CLICK_DISTANCE = 3; // [CSS pixels] shorter drags are clicks

export interface PoseListener {
  choose(pose: number): void;
  /** Move a pose to another place in their order. */
  reorder(from: number, to: number): void;
}

/** Draw key poses at their times [s] on a timeline of some duration [s]. */
export function drawPoses(times: readonly number[], duration: number, listener: PoseListener): HTMLElement {
  const lane = make("div", { class: "lane poses" });
  times.forEach((time, pose) => {
    const made = make(
      "button",
      {
        type: "button",
        class: "pose",
        "aria-label": `Pose ${pose + 1} at ${time.toFixed(2)} s`,
        title: `Pose ${pose + 1}: click to edit it, drag it past another pose (or press an arrow key) to change the order`,
      },
      String(pose + 1),
    );
    made.style.left = `${(100 * time) / duration}%`;
    made.addEventListener("pointerdown", (event) => drag(event, { made, lane, pose, times, duration }, listener));
    made.addEventListener("click", (event) => event.detail === 0 && listener.choose(pose)); // a key, not the pointer
    made.addEventListener("keydown", (event) => {
      const to = pose + ({ ArrowLeft: -1, ArrowRight: 1 }[event.key] ?? 0);
      if (to === pose) return;
      event.stopPropagation();
      if (to >= 0 && to < times.length) listener.reorder(pose, to);
    });
    lane.append(made);
  });
  return make("div", { class: "row" }, make("span", { class: "name" }, "poses"), lane);
}

interface DraggedPose {
  made: HTMLElement;
  lane: HTMLElement;
  pose: number;
  times: readonly number[];
  duration: number;
}

function drag(down: PointerEvent, { made, lane, pose, times, duration }: DraggedPose, listener: PoseListener): void {
  if (down.button !== 0) return;
  down.stopPropagation();
  made.setPointerCapture(down.pointerId);
  const ended = new AbortController();
  const options = { signal: ended.signal };
  const distance = (event: PointerEvent) => event.clientX - down.clientX;
  made.addEventListener("pointermove", (event) => (made.style.translate = `${distance(event)}px`), options);
  made.addEventListener("pointercancel", () => ended.abort(), options);
  made.addEventListener(
    "pointerup",
    (event) => {
      ended.abort();
      made.style.translate = "";
      const time = times[pose]! + (distance(event) / Math.max(lane.clientWidth, 1)) * duration;
      const to = orderAt(times, pose, time);
      if (Math.abs(distance(event)) < CLICK_DISTANCE) listener.choose(pose);
      else if (to !== pose) listener.reorder(pose, to);
    },
    options,
  );
}

/** Return the place in the order that a pose gets at a time [s]. */
export const orderAt = (times: readonly number[], pose: number, time: number): number =>
  times.filter((other, k) => k !== pose && other < time).length;
