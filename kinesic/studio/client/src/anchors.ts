// Points in time of a document, as sync attributes write them.

/** A reference with an offset [s], or a block time [s] without a reference. */
export interface Anchor {
  reference: string | null;
  offset: number;
}

const REFERENCE = /^\s*([A-Za-z_][^\s+]*?)\s*([+-]\s*[\d.]+)?\s*$/;
const NUMBER = /^\s*[+-]?(?:\d+\.?\d*|\.\d+)\s*$/;

/** Format a time [s] with up to three decimals. */
export const formatTime = (seconds: number): string => String(Math.round(seconds * 1000) / 1000);

/** Return the anchor of a block time [s]. */
export const blockTime = (offset: number): Anchor => ({ reference: null, offset });

/** Read the value of a sync attribute; null for other notations. */
export function readAnchor(value: string): Anchor | null {
  if (NUMBER.test(value)) return blockTime(Number(value));
  const parts = value.match(REFERENCE);
  return parts && { reference: parts[1]!, offset: Number((parts[2] ?? "0").replace(/\s/g, "")) };
}

/** Write an anchor that is some seconds later; block times are not negative. */
export function writeAnchor({ reference, offset }: Anchor, later = 0): string {
  const sum = Math.round((offset + later) * 1000) / 1000;
  if (reference === null) return formatTime(Math.max(0, sum));
  return sum === 0 ? reference : `${reference}${sum > 0 ? "+" : ""}${formatTime(sum)}`;
}
