// Actions of the buttons, menus and keys of the page.
import { byId } from "./dom.ts";
import { VIEWS, type View } from "./look.ts";

export interface Actions {
  play(): void;
  perform(): void;
  stop(): void;
  /** Whether surely nothing moves, plays, waits to be performed or has torque. */
  rests(): boolean;
  resume(): void;
  undo(): void;
  redo(): void;
  save(): void;
  saveAs(): void;
  remove(): void;
  show(mode: "plan" | "robot"): void;
  view(view: View): void;
  sectors(on: boolean): void;
  chooseBlock(): void;
  seek(time: number): void;
  style(name: string): void;
  loop(on: boolean): void;
  voice(on: boolean): void;
  list(): void;
  open(kind: string, name: string): void;
  unlock(token: string): void;
}

export function listen(actions: Actions): void {
  for (const name of ["play", "perform", "stop", "resume", "undo", "redo", "save", "remove"] as const)
    byId(name).addEventListener("click", () => actions[name]());
  byId("save-as").addEventListener("click", () => actions.saveAs());
  for (const mode of ["plan", "robot"] as const)
    byId(`mode-${mode}`).addEventListener("click", () => actions.show(mode));
  for (const view of VIEWS) byId(`view-${view}`).addEventListener("click", () => actions.view(view));
  for (const name of ["choose-block", "whole-style"]) byId(name).addEventListener("click", () => actions.chooseBlock());
  const sectors = byId("show-sectors");
  sectors.addEventListener("click", () => {
    const on = sectors.getAttribute("aria-pressed") !== "true";
    sectors.setAttribute("aria-pressed", String(on));
    actions.sectors(on);
  });
  const time = byId<HTMLInputElement>("time");
  time.addEventListener("input", () => actions.seek(Number(time.value)));
  const loop = byId<HTMLInputElement>("loop");
  loop.addEventListener("change", () => actions.loop(loop.checked));
  const voice = byId<HTMLInputElement>("voice");
  voice.addEventListener("change", () => actions.voice(voice.checked));
  const style = byId<HTMLSelectElement>("style");
  style.addEventListener("change", () => actions.style(style.value));
  const menu = byId<HTMLSelectElement>("examples");
  for (const event of ["pointerdown", "focus"]) menu.addEventListener(event, () => actions.list());
  menu.addEventListener("change", () => {
    const at = menu.value.indexOf(":");
    actions.open(menu.value.slice(0, at), menu.value.slice(at + 1));
    menu.value = "";
  });
  byId("lock").addEventListener("submit", (event) => {
    event.preventDefault();
    actions.unlock(byId<HTMLInputElement>("token").value);
  });
  document.addEventListener("keydown", (event) => key(event, actions));
}

function key(event: KeyboardEvent, actions: Actions): void {
  const element = event.target as HTMLElement;
  const writes = element.matches("textarea, input:not([type=range]):not([type=checkbox]), select");
  const presses = element.matches("button, summary, [type=checkbox]");
  if (event.key === "Escape" && closes(event) && actions.rests()) return; // the dialog or menu closes itself
  const stops = event.key === "Escape" || (event.key === " " && !writes && !presses);
  const shortcuts: Record<string, () => void> = {
    z: () => (event.shiftKey ? actions.redo() : actions.undo()),
    Z: actions.redo,
    y: actions.redo,
    s: actions.save,
    S: actions.saveAs,
    Enter: actions.perform,
  };
  const act = stops ? actions.stop : event.ctrlKey || event.metaKey ? shortcuts[event.key] : undefined;
  if (!act) return;
  event.preventDefault();
  act();
}

/** Whether Escape closes a dialog or a menu; the question before arming promises that the key stops. */
function closes(event: KeyboardEvent): boolean {
  if (byId<HTMLDialogElement>("arming").open) return false;
  const isInMenu = event.composedPath().some((each) => (each as Element).matches?.("[role=menu], #saving, #tour"));
  return isInMenu || byId<HTMLDialogElement>("saving").open;
}
