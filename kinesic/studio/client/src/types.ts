// Messages of the server: see docs/reference/wire-protocol.md.

export interface Hinge {
  hinge: number;
  axis: number[];
  at: number[];
}

export interface Body {
  name: string;
  hinges: string[];
  names: string[];
  rest: number[];
  lower: number[];
  upper: number[];
  hands: { l: number; r: number };
  elbows: { l: number; r: number };
  /** First segment of the neck, and position of the eyes; null without a neck. */
  neck: number | null;
  eyes: { segment: number; at: number[]; facing: number[] } | null;
  arm_length: number;
  gesture_origin: number[];
  /** Centres of McNeill's sectors in arm lengths: outward, up, forward. */
  sectors: Record<"x" | "y" | "z", Record<string, number>>;
  segments: { hinges: Hinge[] }[];
  view: { from: number[] };
  /** Surface of the screen on the head that shows the face, or null. */
  screen: { segment: number; picture: Sheet } | null;
}

/** Textured triangles: positions, normals and texture coordinates of the corners. */
export interface Sheet {
  places: number[];
  normals: number[];
  shares: number[];
  triangles: number[];
}

export interface About {
  robot: Body;
  gestures: { id: string; category: string; says: string }[];
  styles: string[];
  examples: { name: string; text: string }[];
  /** Documents to begin a new one with. */
  templates: { name: string; text: string }[];
  document: string | null;
}

export interface Fault {
  line: number;
  column: number;
  text: string;
}

export interface Sync {
  behaviour: string;
  sync: string;
  asked: number;
  planned: number;
}

/** Spoken text between two marks of a speech. */
export interface Piece {
  speech: string;
  mark: string;
  text: string;
  start: number;
  end: number;
}

export interface Behaviour {
  id: string;
  type: string;
  /** Lexeme, target or spoken text. */
  label: string;
  /** Moved body parts, the main one first. */
  tracks: string[];
  outcome: string;
  why: string;
}

export interface Draft {
  block: string;
  duration: number;
  zero: number;
  behaviours: Behaviour[];
  syncs: Sync[];
  words: Piece[];
  phonemes: [string, number][];
  /** Times of the accents of the voice [s]. */
  accents: number[];
  /** Peaks of the voice, one byte per row of the motion, in base64; empty without a voice. */
  loudness: string;
  notices: { type: string; id: string; text: string }[];
  rate: number;
  angles: string;
}

export interface HandKey {
  at: (number | string)[];
  palm?: string;
  pointing?: string;
  shape?: string;
  touch?: string;
}

/** Draft of a gesture under edit. */
export interface GestureDraft extends Draft {
  gesture: string;
  keys: Record<string, HandKey>[];
  times: number[];
  checks: { name: string; ok: boolean; text: string }[];
}

export type Side = "left" | "right";

export interface Reached {
  id: number;
  angles: number[];
  residual: number;
  reached: boolean;
  limits: string[];
  contact: [string, string] | null;
}

export interface ServoPlace {
  bus: string;
  id: number;
  hinge: string;
  model: string;
  /** [C] shutdown temperature. */
  hottest: number;
}

/** State of all servos in list order; null for a servo that does not answer. */
export interface ServoReport {
  state: "limp" | "arming" | "armed" | "releasing" | "ended";
  celsius: (number | null)[];
  load: (number | null)[];
  volts: (number | null)[];
  errors: (number | null)[];
  torque: (number | null)[];
}

export interface BodyReport {
  time: number;
  angles: number[];
  planned: number[];
  hottest: number | null;
  volts: number | null;
  faulty: boolean;
  servos: ServoReport | null;
}
