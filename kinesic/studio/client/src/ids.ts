// New ids that no element of a document has, and that nothing in it refers to.

const VALUE = /([\w:.-]+)\s*=\s*(?:"([^"]*)"|'([^']*)')/g;

/** Return all names in attribute values, of ids as well as of references to missing elements; lexemes are no names. */
function usedNames(text: string): Set<string> {
  const names = new Set<string>();
  for (const [, attribute, double, single] of text.matchAll(VALUE))
    if (attribute !== "lexeme") for (const name of (double ?? single ?? "").match(/\w+/g) ?? []) names.add(name);
  return names;
}

/** Return the first unused id of a stem: with the numbers first, first + 1, and so on; the bare stem counts as 1. */
export function unusedId(text: string, stem: string, isNumbered: boolean): string {
  const used = usedNames(text);
  for (let number = 1; ; number++) {
    const id = isNumbered || number > 1 ? `${stem}${number}` : stem;
    if (!used.has(id)) return id;
  }
}
