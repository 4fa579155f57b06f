// The studio's page without a browser: its own HTML in happy-dom, and WebSockets that a test drives as the server.
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { mock } from "node:test";
import { Window } from "happy-dom";

/** Find page/index.html above the working folder, which is a copy of the client under mutation tests. */
function findPage(): string {
  for (let folder = process.cwd(); folder !== dirname(folder); folder = dirname(folder)) {
    const page = join(folder, "page", "index.html");
    if (existsSync(page)) return readFileSync(page, "utf8");
  }
  throw new Error(`no page/index.html above ${process.cwd()}`);
}

const HTML = findPage().replace(/<(script|link)\b[^>]*>(<\/script>)?/g, "");

/** A WebSocket whose server is the test. */
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

  /** Send the page a message: text as it is, anything else as JSON. */
  tell(message: unknown): void {
    const data = typeof message === "string" ? message : JSON.stringify(message);
    this.dispatchEvent(new MessageEvent("message", { data }));
  }

  /** Return the messages received since the last call, read as JSON. */
  read(): Record<string, unknown>[] {
    return this.sent.splice(0).map((text) => JSON.parse(text) as Record<string, unknown>);
  }
}

/** All sockets that the page has opened, in their order. */
export const sockets: Socket[] = [];

/** Load the page anew, at an address. Its timers wait for `mock.timers.tick`. */
export function load(url = "http://robot.example:8080/"): Window {
  mock.timers.reset();
  mock.timers.enable({ apis: ["setTimeout"] });
  const window = new Window({ url });
  window.document.write(HTML);
  sockets.length = 0;
  const { document, location, sessionStorage, DOMParser, performance } = window;
  Object.assign(globalThis, { document, location, sessionStorage, DOMParser, performance, WebSocket: Socket });
  return window;
}

export const element = <T extends HTMLElement = HTMLElement>(id: string): T => {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as T;
};

/** Click as a person: the browser marks the event as trusted. A script's click is not. */
export function click(window: Window, id: string): void {
  const event = new window.MouseEvent("click", { bubbles: true });
  Object.defineProperty(event, "isTrusted", { value: true });
  element(id).dispatchEvent(event as unknown as Event);
}

/** Press a key on an element; the body by default. Returns whether the page has taken it. */
export function press(window: Window, key: string, options: { on?: Element; ctrlKey?: boolean } = {}): boolean {
  const { on = document.body, ...rest } = options;
  const event = new window.KeyboardEvent("keydown", { key, bubbles: true, cancelable: true, ...rest });
  on.dispatchEvent(event as unknown as Event);
  return event.defaultPrevented;
}

/** Let answers arrive: promises that are settled are followed. */
export const settle = (): Promise<void> => new Promise((done) => setImmediate(done));
