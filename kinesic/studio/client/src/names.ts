// File names: whatever a person types becomes a name that every operating system takes.

const MAX_LENGTH = 64; // [characters] without the suffix
export type Suffix = ".bml" | ".toml";

/** Complete a typed name with a suffix and replace characters that file names cannot have; null without any letter. */
export function fileName(typed: string, suffix: Suffix): string | null {
  const stem = typed
    .trim()
    .replace(/\.(bml|toml|xml)$/i, "")
    .replace(/ß/g, "ss")
    .normalize("NFKD")
    .replace(/\p{M}/gu, "")
    .replace(/[^A-Za-z0-9_-]+/g, "_")
    .replace(/^[_-]+|_+$/g, "")
    .slice(0, MAX_LENGTH);
  return stem ? stem + suffix : null;
}

/** Format a time [ms] as a person reads it: today's without the day. */
export function formatMoment(time: number, now = Date.now()): string {
  const [then, today] = [new Date(time), new Date(now)];
  const clock = then.toLocaleTimeString(undefined, { hour: "2-digit", minute: "2-digit" });
  if (then.toDateString() === today.toDateString()) return clock;
  return `${then.toLocaleDateString(undefined, { day: "numeric", month: "short" })} ${clock}`;
}
