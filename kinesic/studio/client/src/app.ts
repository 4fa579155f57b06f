// Entry of the studio's page: loads the description of the robot and its documents, and opens the page.
import { Studio } from "./studio.ts";
import type { About } from "./types.ts";

declare global {
  interface Window {
    /** Parts of the page, for tests and debugging. */
    kinesicStudio?: Studio;
  }
}

const response = await fetch("studio.json");
window.kinesicStudio = new Studio((await response.json()) as About);
