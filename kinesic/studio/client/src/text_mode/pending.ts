// Words that are typed, but not yet in the performance.

const SPEECH_RATE = 175 / 60; // [words/s] words per second of the voices at rate factor 1

export const splitWords = (text: string): string[] => text.split(/\s+/).filter(Boolean);

/** Number of words and spoken duration of a text. */
export function measure(text: string): string {
  const count = splitWords(text).length;
  return count ? `${formatCount(count)}, about ${Math.max(1, Math.round(count / SPEECH_RATE))} s` : "";
}

/** Describe how the typed text differs from the performed one; empty without typed words or a difference. */
export function describePending(typed: string, performed: string): string {
  const [now, before] = [splitWords(typed), splitWords(performed)];
  if (!now.length || now.join(" ") === before.join(" ")) return "";
  const left = new Map<string, number>();
  for (const word of before) left.set(word, (left.get(word) ?? 0) + 1);
  const count = now.filter((word) => {
    const rest = left.get(word) ?? 0;
    left.set(word, rest - 1);
    return rest <= 0;
  }).length;
  if (count === 0) return "The changed text is not yet in the performance";
  return `${formatCount(count, "new ")} ${count === 1 ? "is" : "are"} not yet in the performance`;
}

const formatCount = (count: number, kind = ""): string => `${count} ${kind}${count === 1 ? "word" : "words"}`;
