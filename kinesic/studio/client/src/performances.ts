// Requests to perform the document and to stop; a stop withdraws a request that is still prepared.
import type { Performing } from "./performing.ts";
import type { Robot } from "./robot.ts";

/** Parts of the page that performances need. */
export interface PerformancesListener {
  /** BML that is performed. */
  bml(): string;
  /** Whether the text field has words that are not in the document yet. */
  hasTypedWords(): boolean;
  /** Choose gestures for the typed words; false if that failed. */
  chooseGestures(): Promise<boolean>;
  /** Whether the document is a gesture whose file the robot does not have. */
  isUnsavedGesture(): boolean;
  /** Whether the page plays the plan. */
  isPlaying(): boolean;
  /** Pause the playback of the plan. */
  pause(): void;
  /** The document was sent to the robot. */
  sent(): void;
}

export class Performances {
  private isPreparing = false; // whether gestures are chosen before a performance
  private requests = 0; // number of requests to perform, and of stops, which withdraw them

  constructor(
    private readonly robot: Robot,
    private readonly performing: Performing,
    private readonly listener: PerformancesListener,
  ) {}

  /** Whether surely nothing moves, plays, waits to be performed or has torque. */
  get rests(): boolean {
    return this.robot.rests && !this.performing.waits && !this.isPreparing && !this.listener.isPlaying();
  }

  /** Choose the gestures of typed words, and perform the document unless a stop withdraws the request. */
  async perform(): Promise<void> {
    this.listener.pause();
    const request = ++this.requests;
    if (this.listener.hasTypedWords() && this.robot.ready) {
      this.isPreparing = true;
      this.performing.prepare();
      const isComplete = await this.listener.chooseGestures();
      this.isPreparing = false;
      if (request !== this.requests) return;
      if (!isComplete) {
        this.performing.fail();
        this.robot.live.say("not performed: the new words have no gestures yet");
        return;
      }
    }
    if (this.listener.isUnsavedGesture()) this.robot.live.say("save the gesture first, so that the robot can use it");
    else if (this.robot.ready) {
      const bml = this.listener.bml();
      this.performing.begin(bml);
      if (this.robot.wire.perform(bml)) this.listener.sent();
      else this.performing.fail();
    }
  }

  /** Stop the robot; a running performance ends when the server has stopped. */
  stop(): void {
    this.requests += 1;
    this.robot.stop();
  }

  /** End the running performance, and withdraw a request that is still prepared. */
  withdraw(): void {
    this.requests += 1;
    this.performing.end();
  }
}
