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

const OUTCOMES: Record<string, string> = {
  substituted: "differs from the request",
  partly: "shown in part",
  dropped: "left out",
};

const NAMED_TYPES: readonly string[] = ["gesture", "speech"]; // types whose labels are names or spoken words

/** Return the label of a behaviour in plain words: `raise brows` for RAISE_BROWS; gestures keep their names. */
export const labelWords = (type: string, label: string): string =>
  NAMED_TYPES.includes(type) || !/^[A-Z_]+$/.test(label) ? label : label.toLowerCase().replaceAll("_", " ");

/** Return the outcome of a behaviour with its reason; empty if the behaviour is performed as requested. */
export const outcomeWords = ({ outcome, why }: { outcome: string; why: string }): string =>
  outcome === "realised" ? "" : [OUTCOMES[outcome] ?? outcome, why].filter(Boolean).join(": ");

export const typeWords = (type: string): string => TYPES[type] ?? type;

export const pointWords = (sync: string): string => POINTS[sync] ?? sync;
