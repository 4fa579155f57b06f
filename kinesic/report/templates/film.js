// A film in step with the replay: an animated WebP is taken apart, so that any moment of it can be shown.
// The container is that of RFC 9649: a RIFF file whose ANMF chunks each hold one picture, or what of it has changed.
const filmOf = (canvas, bytes, shows = () => {}) => {
  const view = new DataView(bytes.buffer);
  const number = (at) => bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16);
  const tag = (at) => String.fromCharCode(...bytes.subarray(at, at + 4));
  const chunks = (from, to) => {
    const found = [];
    for (let at = from; at + 8 <= to; at += 8 + view.getUint32(at + 4, true) + (bytes[at + 4] & 1))
      found.push({ tag: tag(at), at: at + 8, end: at + 8 + view.getUint32(at + 4, true) });
    return found;
  };
  const letters = (text) => Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  const little = (value, count) => Uint8Array.from({ length: count }, (_, k) => (value >> (8 * k)) & 255);
  const still = (at, end, width, height) => {
    const clear = tag(at) === "ALPH";
    const header = [letters("VP8X"), little(10, 4), little(16, 4), little(width - 1, 3), little(height - 1, 3)];
    const parts = [letters("WEBP"), ...(clear ? header : []), bytes.subarray(at, end)];
    const size = parts.reduce((sum, part) => sum + part.length, 0);
    return new Blob([letters("RIFF"), little(size, 4), ...parts], { type: "image/webp" });
  };

  const outer = chunks(12, bytes.length);
  const { at: head } = outer.find((chunk) => chunk.tag === "VP8X");
  canvas.width = number(head + 4) + 1;
  canvas.height = number(head + 7) + 1;
  let begin = 0;
  const frames = outer
    .filter((chunk) => chunk.tag === "ANMF")
    .map(({ at, end }) => {
      const frame = {
        begin,
        left: 2 * number(at),
        top: 2 * number(at + 3),
        width: number(at + 6) + 1,
        height: number(at + 9) + 1,
        vanishes: bytes[at + 15] & 1,
        covers: bytes[at + 15] & 2,
      };
      frame.picture = still(at + 16, end, frame.width, frame.height);
      frame.whole = frame.width === canvas.width && frame.height === canvas.height && (frame.covers || tag(at + 16) !== "ALPH");
      begin += number(at + 12) / 1000;
      return frame;
    });

  const pen = canvas.getContext("2d");
  const clear = ({ left, top, width, height }) => pen.clearRect(left, top, width, height);
  const first = (place) => {
    while (place > 0 && !frames[place].whole) place -= 1;
    return place;
  };
  let shown = -1;
  let wanted = 0;
  let busy = false;
  const work = async () => {
    busy = true;
    while (shown !== wanted) {
      const from = first(wanted);
      const next = wanted < shown || from > shown ? from : shown + 1;
      const picture = await createImageBitmap(frames[next].picture);
      if (shown >= 0 && frames[shown].vanishes) clear(frames[shown]);
      if (frames[next].covers || !next) clear(frames[next]);
      pen.drawImage(picture, frames[next].left, frames[next].top);
      picture.close();
      shown = next;
      if (shown === wanted) shows();
    }
    busy = false;
  };
  return (time) => {
    wanted = Math.max(frames.findLastIndex((frame) => frame.begin <= time + 1e-6), 0);
    if (!busy) work();
  };
};
