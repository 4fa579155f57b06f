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

const NAMED_TYPES: readonly string[] = ["gesture", "speech"]; // types whose labels are names or spoken words

/** Return the label of a behaviour in plain words: `raise brows` for RAISE_BROWS; gestures keep their names. */
export const labelWords = (type: string, label: string): string =>
  NAMED_TYPES.includes(type) || !/^[A-Z_]+$/.test(label) ? label : label.toLowerCase().replaceAll("_", " ");

export const typeWords = (type: string): string => TYPES[type] ?? type;

export const pointWords = (sync: string): string => POINTS[sync] ?? sync;
