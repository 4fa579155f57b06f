// A motion as rows of numbers at a steady rate, which is read between its rows.
const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
const rowAt = ({ end, frames }, rows, unit, time) => {
  const count = rows.length / frames;
  const place = Math.min(Math.max(time / end, 0), 1) * (frames - 1);
  const low = Math.floor(place);
  const high = Math.min(low + 1, frames - 1);
  const share = place - low;
  return Array.from(
    { length: count },
    (_, k) => unit * (rows[low * count + k] * (1 - share) + rows[high * count + k] * share),
  );
};
