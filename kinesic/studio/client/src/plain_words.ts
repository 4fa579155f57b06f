// Plain words for BML's names of behaviours and sync points, as the page shows them.

const TYPES: Record<string, string> = {
  faceLexeme: "face",
  faceFacs: "face",
  faceShift: "face",
  gazeShift: "gaze",
  headDirectionShift: "head",
  pointing: "pointing gesture",
  postureShift: "posture",
  torso: "trunk",
  wait: "pause",
};
const POINTS: Record<string, string> = {
  ready: "hands are ready",
  strokeStart: "stroke begins",
  attackPeak: "peak",
  strokeEnd: "stroke ends",
  relax: "way back begins",
};

const PROGRESS: Record<string, string> = { start: "begins", stroke: "stroke", end: "ends" }; // in messages

const AIMING_TYPES: readonly string[] = ["gaze", "gazeShift", "pointing"]; // types whose label is a target
const TARGETS: Record<string, string> = {
  audience: "the listener",
  upleft: "up left",
  upright: "up right",
  downleft: "down left",
  downright: "down right",
};

const OUTCOMES: Record<string, string> = {
  substituted: "differs from the request",
  partly: "shown in part",
  dropped: "left out",
};

const CATEGORIES: Record<string, string> = {
  adaptor: "touch of oneself",
  beat: "stress",
  deictic: "pointing",
  emblem: "sign",
  emotion: "feeling",
  iconic: "picture",
  metaphoric: "idea",
};

/** Return the name of a gesture in words: `weigh up` for weigh_up. */
export const gestureWords = (id: string): string => id.replaceAll("_", " ");

/** Whether a gesture is a beat, a small movement that stresses a word; `BEAT` is BML's name of the usual one. */
export const isBeat = (id: string): boolean => /^beat(_|$)/i.test(id);

/** Return the id of a gesture that is named in words: weigh_up for `weigh up`. */
export const gestureId = (words: string): string => words.trim().replace(/\s+/g, "_");

/** Return the category of a gesture in plain words: `sign` for an emblem. */
export const categoryWords = (category: string): string => CATEGORIES[category] ?? category;

/** Return the label of a behaviour in plain words: `raise brows` for RAISE_BROWS, `weigh up` for weigh_up. */
export function labelWords(type: string, label: string): string {
  if (type === "gesture") return gestureWords(label);
  if (AIMING_TYPES.includes(type))
    return TARGETS[label.toLowerCase()] ?? (/^[A-Z]+$/.test(label) ? label.toLowerCase() : label);
  return type === "speech" || !/^[A-Z_]+$/.test(label) ? label : label.toLowerCase().replaceAll("_", " ");
}

/** Return the outcome of a behaviour with its reason; empty if the behaviour is performed as requested. */
export const outcomeWords = ({ outcome, why }: { outcome: string; why: string }): string =>
  outcome === "realised" ? "" : [OUTCOMES[outcome] ?? outcome, why].filter(Boolean).join(": ");

/** Write the gesture ids of a text in words: `tiny low needs fingers` for `tiny_low needs fingers`. */
export const withGestureWords = (text: string, isGesture: (id: string) => boolean): string =>
  text.replace(/\b[a-z0-9]+(?:_[a-z0-9]+)+\b/g, (id) => (isGesture(id) ? gestureWords(id) : id));

/** Return the progress of a block or a behaviour in words: `story, wave: stroke ends` for story:wave:strokeEnd. */
export function progressWords(kind: string, about: string): string {
  if (kind === "predictionFeedback") return "the times of the performance are planned";
  const at = about.lastIndexOf(":");
  const point = about.slice(at + 1);
  return at < 0
    ? about || kind
    : `${about.slice(0, at).replaceAll(":", ", ")}: ${PROGRESS[point] ?? pointWords(point)}`;
}

export const typeWords = (type: string): string => TYPES[type] ?? type;

export const pointWords = (sync: string): string => POINTS[sync] ?? sync;
