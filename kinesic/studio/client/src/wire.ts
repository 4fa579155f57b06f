// Connections to the server: one for everything, and one that only stops the robot.

export type Answer = { told: string; id?: number } & Record<string, unknown>;
export type State = "connecting" | "open" | "locked" | "closed";

const FIRST_WAIT = 300; // [ms] before the first attempt to connect again
const LONGEST_WAIT = 4000; // [ms]

/** An answer; null where it is none. */
function parse(text: string): Answer | null {
  try {
    const told: unknown = JSON.parse(text);
    return typeof told === "object" ? (told as Answer | null) : null;
  } catch {
    return null;
  }
}

/** A WebSocket that is opened again whenever it closes. */
class Line {
  private socket: WebSocket | null = null;
  private wait = FIRST_WAIT;
  private again = 0; // the timer of the next attempt; 0: none is due

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

  /** Connects now, where it would wait for its next attempt. */
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
      this.wait = FIRST_WAIT;
      this.opened();
    });
    socket.addEventListener("message", (event) => this.heard(String(event.data)));
    socket.addEventListener("close", () => {
      this.closed();
      this.again = setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
    });
  }
}

/** Sends documents and asks questions; answers find whoever asked by their number. */
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

  /** Sends a document to be performed; false where nobody is there. */
  perform(bml: string): boolean {
    return this.line.send(bml);
  }

  /** Sends a control message that is answered to the listener, if at all. */
  tell(verb: string, values: Record<string, unknown> = {}): boolean {
    return this.line.send(JSON.stringify({ do: verb, ...values }));
  }

  /** Asks a question; null where the connection is lost before the answer. */
  ask(verb: string, values: Record<string, unknown>): Promise<Answer | null> {
    const id = ++this.number;
    return new Promise((answered) => {
      if (!this.line.send(JSON.stringify({ do: verb, id, ...values }))) answered(null);
      else this.waiting.set(id, answered);
    });
  }

  /** Stops the robot by the connection that does nothing else, or else by the other; false where neither is there. */
  stop(): boolean {
    const message = JSON.stringify({ do: "stop" });
    return (this.stopReady && this.stopLine.send(message)) || this.line.send(message);
  }

  /** Shows the token from now on. */
  unlock(token: string): void {
    this.token = token;
    this.greet();
    this.line.hurry();
    this.stopLine.hurry();
  }

  /** Says who is there; the answer tells whether that will do. */
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
    if (answer.told === "welcome" || (answer.told === "status" && this.state !== "open")) this.become("open");
    if (answer.told === "refused" && String(answer.why).includes("token")) this.become("locked");
    const asked = answer.id === undefined ? undefined : this.waiting.get(answer.id);
    if (answer.id !== undefined && asked) {
      this.waiting.delete(answer.id);
      asked(answer);
    } else this.listener.told(answer);
  }

  private lose(): void {
    for (const answered of this.waiting.values()) answered(null);
    this.waiting.clear();
    if (this.state !== "locked") this.become("closed");
  }

  private become(state: State): void {
    this.state = state;
    this.listener.state(state);
  }
}
