// The screen on the robot's head: a plain face painted from action units, and any picture as it is seen there.

// ---- a face of two eyes, brows and a mouth, as kinesic/sim/filming/drawn_face.py paints it ------------------------

const FACE_SIZE = [320, 240];
const paintFace = (pen, units) => {
  const shown = (number, side = "") => Math.max(units[number] ?? 0, side ? (units[side + number] ?? 0) : 0);
  const [ground, light, dark] = ["rgb(20, 26, 38)", "rgb(214, 240, 250)", "rgb(14, 20, 32)"];
  const line = (points, width, filled) => {
    pen.beginPath();
    for (const [x, y] of points) pen.lineTo(x, y);
    pen.lineWidth = width;
    pen.strokeStyle = light;
    pen.lineJoin = "round";
    if (filled) {
      pen.closePath();
      pen.fillStyle = dark;
      pen.fill();
    }
    pen.stroke();
  };
  const oval = (x, y, across, up, colour) => {
    pen.beginPath();
    pen.ellipse(x, y, across, up, 0, 0, 2 * Math.PI);
    pen.fillStyle = colour;
    pen.fill();
  };
  pen.fillStyle = ground;
  pen.fillRect(0, 0, ...FACE_SIZE);
  for (const [side, sign] of [
    ["R", -1],
    ["L", 1],
  ]) {
    const closed = Math.max(shown(43, side), shown(45, side), shown(46, side));
    const open = Math.max(1 - closed - 0.25 * shown(7, side) - 0.2 * shown(6, side), 0);
    const tall = 38 * open * (1 + 0.2 * shown(5, side));
    const [x, y] = [FACE_SIZE[0] / 2 + 68 * sign, 98];
    if (tall < 3) line([[x - 30, y], [x + 30, y]], 5);
    else {
      oval(x, y, 30, tall, light);
      const across = shown(61) - shown(62) - 0.4 * sign * shown(66);
      oval(x + 12 * across, y + 15 * (shown(64) - shown(63)) * open, 16, Math.min(20, 0.9 * tall), dark);
    }
    const frown = 0.6 * shown(4, side);
    const inner = 18 * (shown(1, side) - frown);
    const outer = 18 * (shown(2, side) - 0.4 * frown);
    line([[x - 30 * sign, y - 46 - inner], [x, y - 51 - (inner + outer) / 2], [x + 30 * sign, y - 46 - outer]], 7);
  }
  const narrow = Math.max(shown(18), 0.7 * shown(22), 0.4 * shown(23));
  const parted = Math.max(0.35 * shown(25), shown(26), 1.3 * shown(27), 0.25 * shown(22));
  const drop = 42 * parted * (1 - Math.max(shown(24), shown(28)));
  const [a, b] = [
    ["R", -1],
    ["L", 1],
  ].map(([side, sign]) => [
    FACE_SIZE[0] / 2 + 46 * sign * (1 + 0.25 * shown(12, side) + 0.2 * shown(20, side) - 0.5 * narrow),
    184 - 18 * shown(12, side) + 14 * shown(15, side),
  ]);
  const middle = 188 - 4 * shown(17);
  const arc = (height) =>
    Array.from({ length: 17 }, (_, k) => k / 16).map((s) => [
      (1 - s) ** 2 * a[0] + s * (1 - s) * (a[0] + b[0]) + s * s * b[0],
      (1 - s) ** 2 * a[1] + 2 * s * (1 - s) * (2 * height - (a[1] + b[1]) / 2) + s * s * b[1],
    ]);
  line([...arc(middle - 0.2 * drop), ...arc(middle + 0.8 * drop).reverse()], 6, true);
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
