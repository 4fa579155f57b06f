// Selected behaviours, in the order of their selection.

export class Selection {
  private ids: string[] = [];

  constructor(private readonly changed: () => void) {}

  get all(): ReadonlySet<string> {
    return new Set(this.ids);
  }

  /** The only selected behaviour; null if there are none or several. */
  get single(): string | null {
    return this.ids.length === 1 ? this.ids[0]! : null;
  }

  get last(): string | undefined {
    return this.ids.at(-1);
  }

  has(id: string): boolean {
    return this.ids.includes(id);
  }

  set(ids: readonly string[]): void {
    this.ids = [...new Set(ids)];
    this.changed();
  }

  /** Add a behaviour to the selection, or remove it. */
  extend(id: string): void {
    this.set(this.has(id) ? this.ids.filter((each) => each !== id) : [...this.ids, id]);
  }

  /** Keep only behaviours that exist. */
  keep(existing: ReadonlySet<string>): void {
    const kept = this.ids.filter((id) => existing.has(id));
    if (kept.length !== this.ids.length) this.set(kept);
  }
}
