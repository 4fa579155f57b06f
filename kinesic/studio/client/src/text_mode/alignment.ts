// Alignment of the words of a changed text with the words of the former one.

/** Lower-case letters and digits of a word; punctuation alone counts as itself. */
const plain = (word: string): string => word.toLowerCase().replace(/[^\p{L}\p{N}]+/gu, "") || word;

/** Return the index in the new text for each former word that stays, by the longest common subsequence. */
export function alignWords(former: readonly string[], present: readonly string[]): Map<number, number> {
  const [a, b] = [former.map(plain), present.map(plain)];
  const aligned = new Map<number, number>();
  let start = 0;
  while (start < a.length && start < b.length && a[start] === b[start]) aligned.set(start, start++);
  let [endA, endB] = [a.length, b.length];
  while (endA > start && endB > start && a[endA - 1] === b[endB - 1]) aligned.set(--endA, --endB);
  const width = endB - start + 1;
  const lengths = new Uint16Array((endA - start + 1) * width); // of common subsequences of the remaining words
  const at = (i: number, j: number) => (i - start) * width + j - start;
  for (let i = endA - 1; i >= start; i--)
    for (let j = endB - 1; j >= start; j--)
      lengths[at(i, j)] =
        a[i] === b[j] ? lengths[at(i + 1, j + 1)]! + 1 : Math.max(lengths[at(i + 1, j)]!, lengths[at(i, j + 1)]!);
  for (let [i, j] = [start, start]; i < endA && j < endB; ) {
    if (a[i] === b[j]) aligned.set(i++, j++);
    else if (lengths[at(i + 1, j)]! >= lengths[at(i, j + 1)]!) i++;
    else j++;
  }
  return aligned;
}
