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

export const typeWords = (type: string): string => TYPES[type] ?? type;

export const pointWords = (sync: string): string => POINTS[sync] ?? sync;
