// Scale of the timeline: Ctrl and the wheel, buttons, and the last scale of this browser.
import { recall, remember } from "../remembered.ts";

const MIN_SCALE = 48; // [CSS pixels/s] smallest scale; long documents scroll
const MAX_SCALE = 400; // [CSS pixels/s] largest scale
const PHONEME_SCALE = 130; // [CSS pixels/s] scale from which phonemes are shown
const WHEEL_STEP = 0.002; // relative zoom per pixel of the wheel
const SCALE_KEY = "timeline-scale";

export class Zoom {
  private scale = recall(SCALE_KEY, MIN_SCALE, MIN_SCALE, MAX_SCALE); // [CSS pixels/s]
  private scrolls = false; // whether the timeline is wider than its pane

  constructor(
    private readonly place: HTMLElement,
    private readonly duration: () => number,
  ) {
    const wheel = (event: WheelEvent) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.set((this.lane().width / this.duration()) * Math.exp(-WHEEL_STEP * event.deltaY), event.clientX);
    };
    place.addEventListener("wheel", wheel, { passive: false });
    new ResizeObserver(() => this.spread()).observe(place);
  }

  /** Zoom by a factor around the middle; null: show everything. */
  by(factor: number | null): void {
    const area = this.place.getBoundingClientRect();
    this.set(factor === null ? MIN_SCALE : (this.lane().width / this.duration()) * factor, area.left + area.width / 2);
  }

  /** Apply the scale. */
  spread(): void {
    const inner = this.place.querySelector<HTMLElement>(".inner");
    if (!inner) return;
    inner.style.minWidth = `calc(var(--names) + ${Math.round(this.duration() * this.scale)}px)`;
    inner.classList.toggle("dense", this.lane().width / this.duration() < PHONEME_SCALE);
    this.scrolls = this.place.scrollWidth > this.place.clientWidth;
  }

  lane(): DOMRect {
    return (this.place.querySelector(".lane") ?? this.place).getBoundingClientRect();
  }

  timeAt(x: number): number {
    const area = this.lane();
    return Math.min(Math.max((x - area.left) / area.width, 0), 1) * this.duration();
  }

  /** Scroll so that the playhead is visible. */
  follow(playhead: HTMLElement): void {
    if (!this.scrolls) return;
    const [place, head] = [this.place.getBoundingClientRect(), playhead.getBoundingClientRect()];
    const names = this.lane().left + this.place.scrollLeft - place.left;
    const seen = head.left >= place.left + names && head.left <= place.right;
    if (!seen) this.place.scrollLeft += head.left - place.left - names - 20;
  }

  /** Set the scale [CSS pixels/s]; the time at a page coordinate stays there. */
  private set(scale: number, x: number): void {
    const time = this.timeAt(x);
    this.scale = Math.min(Math.max(scale, MIN_SCALE), MAX_SCALE);
    remember(SCALE_KEY, this.scale);
    this.spread();
    this.place.scrollLeft += ((time / this.duration()) * this.lane().width + this.lane().left - x) | 0;
  }
}
