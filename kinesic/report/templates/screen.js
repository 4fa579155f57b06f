// The screen on the robot's head: a face drawn from action units, and any picture as it is seen there.

// ---- a face of eyes, lids, brows and a mouth, as kinesic/sim/filming/drawn_face.py draws it -------------------------

const FACE_SIZE = [320, 240];
const FACE_COLOURS = { ground: "rgb(12, 18, 30)", line: "rgb(196, 240, 255)", pupil: "rgb(16, 34, 62)", glint: "#fff" };
const STRIP = Array.from({ length: 25 }, (_, k) => k / 24);
const paintFace = (pen, units) => {
  const shown = (number, side = "") => Math.max(units[number] ?? 0, side ? (units[side + number] ?? 0) : 0);
  // Fills what is between two rows of points, at the same places across or each at its own.
  const strip = (colour, across, above, below) => {
    pen.beginPath();
    STRIP.forEach((_, k) => pen.lineTo(across[k], above[k]));
    for (let k = STRIP.length - 1; k >= 0; k--) pen.lineTo(across[k], below[k]);
    pen.fillStyle = colour;
    pen.fill();
  };
  const along = STRIP.map((s) => 2 * s - 1);
  const cosine = STRIP.map((s) => Math.cos(Math.PI * (1 - s)));
  const sine = STRIP.map((s) => Math.sin(Math.PI * (1 - s)));
  const ends = along.map((a) => Math.sqrt(1 - Math.abs(a) ** 8));
  const oval = (colour, x, y, wide, tall) =>
    strip(
      colour,
      cosine.map((c) => x + wide * c),
      sine.map((s) => y - tall * s),
      sine.map((s) => y + tall * s),
    );
  const mix = (share, one, other) => (1 - share) * one + share * other;
  pen.fillStyle = FACE_COLOURS.ground;
  pen.fillRect(0, 0, ...FACE_SIZE);
  const sides = [
    ["R", -1],
    ["L", 1],
  ];
  for (const [side, sign] of sides) {
    const unit = (number) => shown(number, side);
    const closed = Math.max(unit(43), unit(45), unit(46));
    const smile = Math.min(Math.max(unit(6), 0.45 * unit(12)), 1);
    const frown = unit(4) * (1 - 0.7 * unit(1));
    const sorrow = unit(1) * (1 - unit(2));
    const height = 45 * (1 + 0.15 * unit(5));
    const sag = 9 - 20 * smile;
    const upper = mix(closed, (height + 3) * (1 - 0.25 * unit(7)) - 0.35 * 45 * frown, 4 - sag);
    const lower = mix(closed, (height + 3) * (1 - 0.3 * unit(7) - 0.7 * smile), 4 + sag);
    const tilt = (1 - closed) * 17 * (frown - 0.7 * sorrow);
    const [x, y] = [FACE_SIZE[0] / 2 + 68 * sign, 106];
    const px = x + 13 * (shown(61) - shown(62) - 0.4 * sign * shown(66));
    const py = y - 15 * (shown(63) - shown(64)) * (1 - closed);
    const tall = 23 * (1 - closed);
    oval(FACE_COLOURS.line, x, y, 35, height);
    oval(FACE_COLOURS.pupil, px, py, 18, tall);
    oval(FACE_COLOURS.glint, px - 6, py - 0.42 * tall, 5.5, 0.28 * tall);
    const lid = cosine.map((c) => x + 38 * c);
    strip(
      FACE_COLOURS.ground,
      lid,
      STRIP.map(() => y - 59),
      sine.map((s, k) => y - upper * s - sign * tilt * cosine[k]),
    );
    strip(
      FACE_COLOURS.ground,
      lid,
      sine.map((s) => y + lower * s),
      STRIP.map(() => y + 59),
    );
    const inner = 19 * (unit(1) - 0.9 * unit(4) * (1 - 0.8 * unit(1)));
    const outer = 19 * (unit(2) - 0.2 * unit(4) - 0.25 * sorrow);
    const brow = along.map((a) => y - 62 - mix((1 + sign * a) / 2, inner, outer) - 6 * (1 - a * a));
    strip(
      FACE_COLOURS.line,
      along.map((a) => x + 32 * a - 6 * sign * unit(4)),
      brow.map((middle, k) => middle - 6 * ends[k]),
      brow.map((middle, k) => middle + 6 * ends[k]),
    );
  }
  const most = (number) => Math.max(shown(number, "R"), shown(number, "L"));
  const narrow = Math.max(most(18), 0.7 * most(22), 0.4 * most(23), 0.25 * most(24));
  const pressed = Math.max(most(24), most(28), 0.7 * most(23));
  const parted = Math.max(0.3 * most(25), most(26), 1.3 * most(27), 0.3 * most(22)) * (1 - Math.max(most(24), most(28)));
  const [[left, leftTop], [right, rightTop]] = sides.map(([side, sign]) => [
    FACE_SIZE[0] / 2 +
      46 * sign * (1 + 0.3 * shown(12, side) + 0.2 * shown(20, side) + 0.12 * shown(14, side) - 0.5 * narrow),
    188 - 17 * shown(12, side) - 5 * shown(14, side) + 15 * shown(15, side),
  ]);
  const bend = 5 + 4 * most(12) - 9 * most(15) - 6 * most(17);
  const high = 188 + bend - (0.22 + 0.2 * narrow) * 46 * parted - 7 * Math.max(most(10), 0.6 * most(9));
  const low = 188 + bend + (0.78 - 0.1 * narrow) * 46 * parted + 6 * most(16) - 4 * most(10);
  const thick = 6 * (1 - 0.35 * pressed);
  const row = (middle, sign) =>
    STRIP.map(
      (s, k) => mix(s, leftTop, rightTop) + 4 * s * (1 - s) * (middle - (leftTop + rightTop) / 2) + sign * thick * ends[k],
    );
  strip(
    FACE_COLOURS.line,
    STRIP.map((s) => mix(s, left, right)),
    row(high, -1),
    row(low, 1),
  );
};
const plainFace = () => {
  const paper = document.createElement("canvas");
  [paper.width, paper.height] = FACE_SIZE;
  const pen = paper.getContext("2d");
  paintFace(pen, {});
  return { paper, pen };
};

// ---- the screen itself ------------------------------------------------------------------------------------------

// The corners of a sheet's triangles, as shapes have them: place and normal, and on request where in the picture.
const cornersOf = ({ places, normals, shares, triangles }, pictured) =>
  triangles.flatMap((k) => [
    ...places.slice(3 * k, 3 * k + 3),
    ...normals.slice(3 * k, 3 * k + 3),
    ...(pictured ? shares.slice(2 * k, 2 * k + 2) : []),
  ]);

const SCREEN = [
  `#version 300 es
  in vec3 place, normal; in vec2 share; uniform mat4 frame, view; out vec3 n; out vec2 at;
  void main() { at = share; n = mat3(frame) * normal; gl_Position = view * frame * vec4(place, 1.0); }`,
  `#version 300 es
  precision highp float; in vec3 n; in vec2 at; uniform sampler2D face; out vec4 drawn;
  void main() {
    float light = 0.85 + 0.15 * max(dot(normalize(n), normalize(vec3(0.5, 0.45, 0.8))), 0.0);
    drawn = vec4(texture(face, at).rgb * light, 1.0);
  }`,
];
// Makes what draws a picture on the screen of a scene: the program is made as the scene makes its own.
const screenOf = (gl, { picture }, program) => {
  const made = program(SCREEN);
  const corners = cornersOf(picture, true);
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(corners), gl.STATIC_DRAW);
  for (const [attribute, size, offset] of [
    [0, 3, 0],
    [1, 3, 12],
    [2, 2, 24],
  ]) {
    gl.enableVertexAttribArray(attribute);
    gl.vertexAttribPointer(attribute, size, gl.FLOAT, false, 32, offset);
  }
  gl.bindVertexArray(null);
  const texture = gl.createTexture();
  const plain = plainFace().paper;
  let seen = null; // what the texture holds; a picture that is given may be painted anew, this one is not
  return (frame, view, shown) => {
    gl.useProgram(made.made);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    if (shown || seen !== plain) {
      seen = shown ?? plain;
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, seen);
      gl.generateMipmap(gl.TEXTURE_2D);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    }
    gl.uniformMatrix4fv(made.at("frame"), false, frame);
    gl.uniformMatrix4fv(made.at("view"), false, view);
    gl.bindVertexArray(array);
    gl.drawArrays(gl.TRIANGLES, 0, corners.length / 8);
    gl.bindVertexArray(null);
  };
};
