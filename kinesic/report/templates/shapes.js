// Vectors, and the robot's shapes as triangles: six numbers for each corner, its place and its normal.
"use strict";

// ---- vectors ------------------------------------------------------------------------------------------------

const add = (a, b, scale = 1) => a.map((value, k) => value + scale * b[k]);
const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);
const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];
const unit = (a) => {
  const size = Math.hypot(...a);
  return size > 1e-9 ? a.map((value) => value / size) : [0, 0, 1];
};

// ---- shapes: triangles with normals, in the frame of their segment ------------------------------------------

const AROUND = 20;
const RINGS = 5;
const capsule = ([ax, ay, az, bx, by, bz, radius]) => {
  const a = [ax, ay, az];
  const b = [bx, by, bz];
  const up = unit(add(b, a, -1));
  const side = unit(cross(up, Math.abs(up[0]) < 0.7 ? [1, 0, 0] : [0, 1, 0]));
  const front = cross(up, side);
  const rings = [];
  for (const [end, from, to] of [
    [a, -Math.PI / 2, 0],
    [b, 0, Math.PI / 2],
  ])
    for (let ring = 0; ring <= RINGS; ring++) {
      const height = from + ((to - from) * ring) / RINGS;
      rings.push(
        Array.from({ length: AROUND + 1 }, (_, k) => {
          const turn = (2 * Math.PI * k) / AROUND;
          const flat = Math.cos(height);
          const normal = add(
            add(
              up.map((v) => v * Math.sin(height)),
              side,
              flat * Math.cos(turn),
            ),
            front,
            flat * Math.sin(turn),
          );
          return [...add(end, normal, radius), ...normal];
        }),
      );
    }
  return rings
    .slice(1)
    .flatMap((ring, k) =>
      ring.slice(1).flatMap((point, j) => [rings[k][j], rings[k][j + 1], point, rings[k][j], point, ring[j]].flat()),
    );
};
const box = (at, half) =>
  [0, 1, 2].flatMap((axis) =>
    [-1, 1].flatMap((sign) => {
      const normal = [0, 0, 0];
      normal[axis] = sign;
      const corner = (u, v) => {
        const place = [...at];
        place[axis] += sign * half[axis];
        place[(axis + 1) % 3] += u * half[(axis + 1) % 3];
        place[(axis + 2) % 3] += v * half[(axis + 2) % 3];
        return [...place, ...normal];
      };
      return [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, -1), corner(1, 1), corner(-1, 1)].flat();
    }),
  );

// A surface as `scene_data` packs it: six numbers for each vertex, and the corners of triangles.
const surface = ({ vertices, normals, shell, joint }, step) => {
  const places = new Int16Array(bytesOf(vertices).buffer);
  const directions = new Int8Array(bytesOf(normals).buffer);
  const mesh = new Float32Array(2 * places.length);
  for (let k = 0; k < places.length; k++) {
    const at = 6 * Math.floor(k / 3) + (k % 3);
    mesh[at] = places[k] * step;
    mesh[at + 3] = directions[k] / 127;
  }
  return { mesh, shell: new Uint16Array(bytesOf(shell).buffer), joint: new Uint16Array(bytesOf(joint).buffer) };
};
