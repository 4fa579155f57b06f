// BML feedback of the server.

export interface Feedback {
  kind: string;
  /** Id of the block, sync point or behaviour, or the character. */
  about: string;
  /** [s] time of the server, if the message has one. */
  time: number | null;
  text: string;
}

export function readFeedback(xml: string): Feedback {
  const root = new DOMParser().parseFromString(xml, "text/xml").documentElement;
  const time = root.getAttribute("globalTime");
  return {
    kind: root.localName,
    about: root.getAttribute("id") ?? root.getAttribute("characterId") ?? "",
    time: time === null ? null : Number(time),
    text: root.textContent?.trim() ?? "",
  };
}
