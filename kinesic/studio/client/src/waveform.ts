// Waveform of a voice, symmetric about a line.
const HALF_HEIGHT = 50; // units of half the height

/** Draw peaks (0..255) at a number of peaks per width. */
export function drawWaveform(peaks: Uint8Array, wide: number): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", `0 ${-HALF_HEIGHT} ${wide} ${2 * HALF_HEIGHT}`);
  svg.setAttribute("preserveAspectRatio", "none");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  const above = Array.from(peaks, (peak, k) => `${k} ${((-HALF_HEIGHT * peak) / 255).toFixed(1)}`);
  const below = Array.from(peaks, (peak, k) => `${k} ${((HALF_HEIGHT * peak) / 255).toFixed(1)}`).reverse();
  path.setAttribute("d", `M${[...above, ...below].join("L")}Z`);
  svg.append(path);
  return svg;
}
