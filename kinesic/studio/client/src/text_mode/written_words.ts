// Words of the speeches in the text of a document, before it is planned.
import { findAttribute, findTags, isMark, unescapeXml } from "../xml.ts";

/** Word with the preceding mark of its speech, and its index among the words after this mark. */
export interface WrittenWord {
  speech: string;
  mark: string;
  index: number;
  text: string;
}

const START = "start"; // stands for the beginning of a speech instead of a mark

/** Return all spoken words of a document in order. */
export function readWords(text: string): WrittenWord[] {
  const tags = findTags(text);
  return tags.flatMap((tag, first) => {
    const speech = tag.name === "speech" && !tag.closing && !tag.empty ? findAttribute(tag, "id")?.value : undefined;
    if (speech === undefined) return [];
    const inside = tags.slice(
      first + 1,
      tags.findIndex((each, k) => k > first && each.closing && each.name === tag.name),
    );
    const begin = inside.findIndex(({ name, closing }) => name === "text" && !closing);
    const end = inside.findIndex(({ name, closing }) => name === "text" && closing);
    return begin < 0 || end < 0 ? [] : readPieces(text, inside.slice(begin, end + 1), speech);
  });
}

/** Return the words between tags; only marks and blanks divide words. */
function readPieces(text: string, tags: ReturnType<typeof findTags>, speech: string): WrittenWord[] {
  const pieces = [{ mark: START, text: "" }];
  for (const [k, tag] of tags.entries()) {
    if (isMark(tag) && !tag.closing) pieces.push({ mark: findAttribute(tag, "id")?.value ?? "", text: "" });
    const next = tags[k + 1];
    if (next) pieces.at(-1)!.text += text.slice(tag.to, next.from).replace(/<!--[\s\S]*?-->/g, "");
  }
  return pieces.flatMap(({ mark, text: piece }) =>
    [...unescapeXml(piece).matchAll(/\S+/g)].map(([word], index) => ({ speech, mark, index, text: word })),
  );
}
