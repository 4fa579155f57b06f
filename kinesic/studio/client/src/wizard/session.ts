// Session of a wizard: every press and every state of the robot with its time, as tables and for a replay.

/** One message to the robot. */
export interface Deed {
  do: string; // `do` value of the message, or `bml` for a document
  values: Record<string, unknown>;
}

/** One press of the wizard, or one new state of the robot. */
export interface Entry {
  time: number; // [s] since the start of the session
  kind: "press" | "state";
  label: string;
  deeds: readonly Deed[]; // messages of a press
}

const PRESS_LENGTH = 200; // [ms] longest annotation of a press in EAF
const SCHEMA =
  'xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.mpi.nl/tools/elan/EAFv3.0.xsd"';
const QUOTED = /[",\r\n]/;

export class Session {
  readonly entries: Entry[] = [];
  private begin: number | null = null; // [ms] time of the first entry

  /** Add an entry at a time [ms]. */
  add(now: number, kind: Entry["kind"], label: string, deeds: readonly Deed[] = []): void {
    this.begin ??= now;
    this.entries.push({ time: (now - this.begin) / 1000, kind, label, deeds });
  }

  clear(): void {
    this.entries.length = 0;
    this.begin = null;
  }

  get presses(): Entry[] {
    return this.entries.filter(({ kind }) => kind === "press");
  }

  /** Return the session as CSV. */
  csv(): string {
    const cell = (text: string) => (QUOTED.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const rows = this.entries.map(({ time, kind, label }) => [time.toFixed(3), kind, cell(label)].join(","));
    return `${["time [s],kind,label", ...rows].join("\n")}\n`;
  }

  /** Return the session as an EAF document of ELAN, with a tier for presses and one for states. */
  eaf(date: Date): string {
    const times: number[] = []; // [ms] of each time slot
    const slot = (time: number) => `ts${times.push(time)}`;
    let count = 0;
    const tier = (id: string, kind: Entry["kind"], longest: number) => {
      const entries = this.entries.filter((entry) => entry.kind === kind);
      const end = Math.round(1000 * (this.entries.at(-1)?.time ?? 0)) + PRESS_LENGTH;
      const annotations = entries.map(({ time, label }, k) => {
        const [from, next] = [Math.round(1000 * time), entries[k + 1]];
        const to = Math.max(from + 1, Math.min(from + longest, next ? Math.round(1000 * next.time) : end));
        const references = `TIME_SLOT_REF1="${slot(from)}" TIME_SLOT_REF2="${slot(to)}"`;
        const value = `<ANNOTATION_VALUE>${escapeXml(label)}</ANNOTATION_VALUE>`;
        return `<ANNOTATION><ALIGNABLE_ANNOTATION ANNOTATION_ID="a${++count}" ${references}>${value}</ALIGNABLE_ANNOTATION></ANNOTATION>`;
      });
      return `<TIER TIER_ID="${id}" LINGUISTIC_TYPE_REF="default-lt">${annotations.join("")}</TIER>`;
    };
    const tiers = [tier("wizard", "press", PRESS_LENGTH), tier("robot", "state", Number.POSITIVE_INFINITY)];
    const slots = times.map((time, k) => `<TIME_SLOT TIME_SLOT_ID="ts${k + 1}" TIME_VALUE="${time}"/>`);
    return `<?xml version="1.0" encoding="UTF-8"?>
<ANNOTATION_DOCUMENT AUTHOR="kinesic" DATE="${date.toISOString()}" FORMAT="3.0" VERSION="3.0" ${SCHEMA}>
<HEADER MEDIA_FILE="" TIME_UNITS="milliseconds"/>
<TIME_ORDER>${slots.join("")}</TIME_ORDER>
${tiers.join("\n")}
<LINGUISTIC_TYPE GRAPHIC_REFERENCES="false" LINGUISTIC_TYPE_ID="default-lt" TIME_ALIGNABLE="true"/>
</ANNOTATION_DOCUMENT>
`;
  }
}

const escapeXml = (text: string) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
