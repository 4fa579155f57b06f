// Documents in the server's folder, and their earlier versions.
import type { Wire } from "./wire.ts";

/** File in the folder; its revision changes with its content. */
export interface Stored {
  name: string;
  text: string;
  revision: string;
}

export interface Version {
  number: number;
  /** [s] Unix time at which a newer text replaced it. */
  time: number;
}

/** Result of a request to save: the new revision, or why not. */
export type SaveResult = { revision: string } | { why: string; conflict: boolean };

export class Documents {
  constructor(
    private readonly wire: Wire,
    private readonly say: (text: string) => void,
  ) {}

  /** Read a document; null, after a message, if that fails. */
  async open(name: string): Promise<Stored | null> {
    const answer = await this.wire.ask("open", { name });
    if (answer?.told === "document")
      return { name, text: String(answer.text), revision: String(answer.revision ?? "") };
    this.say(String(answer?.why ?? "no server"));
    return null;
  }

  /** Save a text; with a revision, only a file of this revision is replaced, and with "" none. */
  async save(name: string, text: string, revision: string | null): Promise<SaveResult> {
    const answer = await this.wire.ask("save", { name, text, revision });
    if (answer?.told === "saved") return { revision: String(answer.revision ?? "") };
    return { why: String(answer?.why ?? "no server"), conflict: answer?.conflict === true };
  }

  async list(): Promise<string[]> {
    const answer = await this.wire.ask("open", {});
    return (answer?.names as string[] | undefined) ?? [];
  }

  /** Return the versions of a document, the newest first. */
  async versions(name: string): Promise<Version[]> {
    const answer = await this.wire.ask("versions", { name });
    return (answer?.versions as Version[] | undefined) ?? [];
  }

  /** Read a version; null, after a message, if that fails. */
  async version(name: string, number: number): Promise<string | null> {
    const answer = await this.wire.ask("versions", { name, number });
    if (answer?.told === "version") return String(answer.text);
    this.say(String(answer?.why ?? "no server"));
    return null;
  }
}
