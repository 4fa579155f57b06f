// Steps of the tour: what each part of the page is for.

export interface Step {
  /** Selector of the part that it explains. */
  part: string;
  title: string;
  text: string;
}

export const STEPS: readonly Step[] = [
  {
    part: "#stage",
    title: "The robot",
    text: "Play shows the plan of the document here. Drag to turn the view, or drag a hand to see how far it reaches.",
  },
  {
    part: "#plain-form",
    title: "Type what it should say",
    text: "Choose gestures writes a whole performance for your text, with gestures, gaze and expressions.",
  },
  {
    part: "#spoken",
    title: "A gesture on its word",
    text: "Click a word to see why it has its gesture, and to choose another one from a ranked list.",
  },
  {
    part: "#timeline",
    title: "Change the times",
    text: "Drag the orange mark of a gesture onto another word. Add has nods, gazes, smiles and pauses.",
  },
  {
    part: "#choose-block",
    title: "Give it a style",
    text: "Style shows how the whole performance moves, on eight sliders. Select a gesture to style it alone.",
  },
  {
    part: "#control",
    title: "Perform, and stop",
    text: "Perform plays the document on the robot. Stop, Space and Escape end every movement at once.",
  },
];
