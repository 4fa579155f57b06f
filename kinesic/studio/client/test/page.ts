// The studio's HTML page in happy-dom, and WebSockets driven by a test.
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { mock } from "node:test";
import { Window } from "happy-dom";

/** Find page/index.html above the working folder, a copy of the client under mutation tests. */
function findPage(): string {
  for (let folder = process.cwd(); folder !== dirname(folder); folder = dirname(folder)) {
    const page = join(folder, "page", "index.html");
    if (existsSync(page)) return readFileSync(page, "utf8");
  }
  throw new Error(`no page/index.html above ${process.cwd()}`);
}

const HTML = findPage().replace(/<(script|link)\b[^>]*>(<\/script>)?/g, "");

/** WebSocket whose server is the test. */
export class Socket extends EventTarget {
  static readonly OPEN = 1;
  readyState = 0;
  readonly sent: string[] = [];

  constructor(readonly url: string) {
    super();
    sockets.push(this);
  }

  send(text: string): void {
    this.sent.push(text);
  }

  open(): void {
    this.readyState = Socket.OPEN;
    this.dispatchEvent(new Event("open"));
  }

  close(): void {
    this.readyState = 3;
    this.dispatchEvent(new Event("close"));
  }

  /** Send a message to the page: text unchanged, other values as JSON. */
  tell(message: unknown): void {
    const data = typeof message === "string" ? message : JSON.stringify(message);
    this.dispatchEvent(new MessageEvent("message", { data }));
  }

  /** Return the parsed messages since the last call. */
  read(): Record<string, unknown>[] {
    return this.sent.splice(0).map((text) => JSON.parse(text) as Record<string, unknown>);
  }
}

/** All sockets opened by the page, in order. */
export const sockets: Socket[] = [];

/** Reload the page at an address. Its timers wait for `mock.timers.tick`. */
export function load(url = "http://robot.example:8080/"): Window {
  mock.timers.reset();
  mock.timers.enable({ apis: ["setTimeout"] });
  const window = new Window({ url });
  window.document.write(HTML);
  sockets.length = 0;
  const { document, location, localStorage, sessionStorage, DOMParser, performance } = window;
  Object.assign(globalThis, { window, document, location, localStorage, sessionStorage, DOMParser, performance });
  Object.assign(globalThis, { WebSocket: Socket });
  Object.defineProperty(globalThis, "navigator", { value: window.navigator, configurable: true });
  return window;
}

export const element = <T extends HTMLElement = HTMLElement>(id: string): T => {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as T;
};

/** Click like a person: the event is trusted, in contrast to a script's click. */
export function click(window: Window, id: string): void {
  const event = new window.MouseEvent("click", { bubbles: true });
  Object.defineProperty(event, "isTrusted", { value: true });
  element(id).dispatchEvent(event as unknown as Event);
}

/** Press a key on an element, by default the body. Returns whether the page has handled it. */
export function press(window: Window, key: string, options: { on?: Element; ctrlKey?: boolean } = {}): boolean {
  const { on = document.body, ...rest } = options;
  const event = new window.KeyboardEvent("keydown", { key, bubbles: true, cancelable: true, ...rest });
  on.dispatchEvent(event as unknown as Event);
  return event.defaultPrevented;
}

/** Let settled promises continue. */
export const settle = (): Promise<void> => new Promise((done) => setImmediate(done));
