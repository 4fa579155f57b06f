// Connections to the server: one for everything, and one that only stops the robot.

export type Answer = { told: string; id?: number } & Record<string, unknown>;
export type State = "connecting" | "open" | "locked" | "closed";

const MIN_RETRY_DELAY = 300; // [ms] before the first attempt to reconnect
const MAX_RETRY_DELAY = 4000; // [ms] longest time between attempts

/** Parse an answer; null if it is invalid. */
function parse(text: string): Answer | null {
  try {
    const told: unknown = JSON.parse(text);
    return typeof told === "object" ? (told as Answer | null) : null;
  } catch {
    return null;
  }
}

/** WebSocket that reconnects after every close. */
class Line {
  private socket: WebSocket | null = null;
  private wait = MIN_RETRY_DELAY;
  private again = 0; // timer of the next attempt; 0: none

  constructor(
    private readonly opened: () => void,
    private readonly heard: (text: string) => void,
    private readonly closed: () => void,
  ) {
    this.connect();
  }

  send(text: string): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(text);
    return true;
  }

  /** Connect at once instead of at the next attempt. */
  hurry(): void {
    if (!this.again) return;
    clearTimeout(this.again);
    this.connect();
  }

  private connect(): void {
    this.again = 0;
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/`);
    this.socket = socket;
    socket.addEventListener("open", () => {
      this.wait = MIN_RETRY_DELAY;
      this.opened();
    });
    socket.addEventListener("message", (event) => this.heard(String(event.data)));
    socket.addEventListener("close", () => {
      this.closed();
      this.again = setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(2 * this.wait, MAX_RETRY_DELAY);
    });
  }
}

/** Sends documents and requests; answers are matched to requests by number. */
export class Wire {
  state: State = "connecting";
  private readonly line: Line;
  private readonly stopLine: Line;
  private readonly waiting = new Map<number, (answer: Answer | null) => void>();
  private stopReady = false;
  private number = 0;

  constructor(
    private readonly listener: { state(state: State): void; told(answer: Answer): void; feedback(xml: string): void },
    private token: string | null,
  ) {
    this.line = new Line(
      () => this.greet(),
      (text) => this.hear(text),
      () => this.lose(),
    );
    this.stopLine = new Line(
      () => {
        if (this.token !== null) this.stopLine.send(JSON.stringify({ do: "hello", token: this.token }));
        this.stopLine.send(JSON.stringify({ do: "stop_line" }));
      },
      (text) => {
        const answer = parse(text);
        this.stopReady ||= answer?.told === "stop_line";
        if (answer?.told === "stopped" || answer?.told === "failed") this.listener.told(answer);
      },
      () => {
        this.stopReady = false;
      },
    );
  }

  /** Send a document to perform; false without a connection. */
  perform(bml: string): boolean {
    return this.line.send(bml);
  }

  /** Send a control message; answers go to the listener. */
  tell(verb: string, values: Record<string, unknown> = {}): boolean {
    return this.line.send(JSON.stringify({ do: verb, ...values }));
  }

  /** Send a request and return its answer; null if the connection closes first. */
  ask(verb: string, values: Record<string, unknown>): Promise<Answer | null> {
    const id = ++this.number;
    return new Promise((answered) => {
      if (!this.line.send(JSON.stringify({ do: verb, id, ...values }))) answered(null);
      else this.waiting.set(id, answered);
    });
  }

  /** Stop the robot by the stop line, or else by the other line; false without either. */
  stop(): boolean {
    const message = JSON.stringify({ do: "stop" });
    return (this.stopReady && this.stopLine.send(message)) || this.line.send(message);
  }

  /** Use a token from now on. */
  unlock(token: string): void {
    this.token = token;
    this.greet();
    this.line.hurry();
    this.stopLine.hurry();
  }

  /** Identify the client; the answer grants or refuses access. */
  private greet(): void {
    if (this.token === null) this.tell("status");
    else this.tell("hello", { token: this.token });
  }

  private hear(text: string): void {
    if (!text.startsWith("{")) {
      this.listener.feedback(text);
      return;
    }
    const answer = parse(text);
    if (!answer) return;
    if (answer.told === "welcome" || (answer.told === "status" && this.state !== "open")) this.setState("open");
    if (answer.told === "refused" && String(answer.why).includes("token")) this.setState("locked");
    const asked = answer.id === undefined ? undefined : this.waiting.get(answer.id);
    if (answer.id !== undefined && asked) {
      this.waiting.delete(answer.id);
      asked(answer);
    } else this.listener.told(answer);
  }

  private lose(): void {
    for (const answered of this.waiting.values()) answered(null);
    this.waiting.clear();
    if (this.state !== "locked") this.setState("closed");
  }

  private setState(state: State): void {
    this.state = state;
    this.listener.state(state);
  }
}
