// How loud a voice is, as a shape about a line.
const HALF = 50; // units of half the height

/** Draws peaks (0..255), of which so many would fill the width. */
export function drawWaveform(peaks: Uint8Array, wide: number): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", `0 ${-HALF} ${wide} ${2 * HALF}`);
  svg.setAttribute("preserveAspectRatio", "none");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  const above = Array.from(peaks, (peak, k) => `${k} ${((-HALF * peak) / 255).toFixed(1)}`);
  const below = Array.from(peaks, (peak, k) => `${k} ${((HALF * peak) / 255).toFixed(1)}`).reverse();
  path.setAttribute("d", `M${[...above, ...below].join("L")}Z`);
  svg.append(path);
  return svg;
}
