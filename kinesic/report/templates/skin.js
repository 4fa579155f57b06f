// The skin of a figure: frames that follow the hinges move its vertices, and clothes are cut for each pixel.

// ---- turns as quaternions: w, x, y, z -----------------------------------------------------------------------

const turnAbout = ([x, y, z], angle) => {
  const s = Math.sin(angle / 2);
  return [Math.cos(angle / 2), s * x, s * y, s * z];
};
const turnTwice = ([a, b, c, d], [w, x, y, z]) => [
  a * w - b * x - c * y - d * z,
  a * x + b * w + c * z - d * y,
  a * y - b * z + c * w + d * x,
  a * z + b * y - c * x + d * w,
];
// A share of a turn, the way that the hinges went, also beyond half a turn.
const turnPartly = (turn, share) => {
  const sine = Math.hypot(turn[1], turn[2], turn[3]);
  if (share === 1 || sine < 1e-9) return turn;
  const half = share * Math.atan2(sine, turn[0]);
  const scale = Math.sin(half) / sine;
  return [Math.cos(half), scale * turn[1], scale * turn[2], scale * turn[3]];
};
const rowsOf = ([w, x, y, z]) => [
  [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
  [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
  [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
];

// How each frame, and each eye, moves skin from where it was made: three rows of four numbers, and four of its tint.
const bonesOf = ({ bones, head, eyeballs }, placed, angles, { tints = () => [0, 0, 0, 0], gaze = [0, 0, 0, 0, 0, 0] } = {}) => {
  const found = new Float32Array(16 * (bones.length + eyeballs.length));
  bones.forEach(({ segment, parent, share, turns, back }, k) => {
    const own = placed[segment];
    const from = turns.length ? placed[parent] : own;
    let rows = [0, 1, 2].map((row) => [0, 1, 2].map((column) => from[4 * column + row]));
    if (turns.length) {
      let swing = [1, 0, 0, 0];
      let twisted = [1, 0, 0, 0];
      for (const { hinge, axis, twist } of turns)
        if (twist === undefined) swing = turnTwice(swing, turnAbout(axis, angles[hinge]));
        else twisted = turnAbout(axis, twist * angles[hinge]);
      const local = rowsOf(turnTwice(turnPartly(swing, share), twisted));
      rows = rows.map((row) => [0, 1, 2].map((column) => local.reduce((sum, line, j) => sum + row[j] * line[column], 0)));
    }
    for (let row = 0; row < 3; row++) {
      for (let column = 0; column < 4; column++)
        for (let j = 0; j < 3; j++) found[16 * k + 4 * row + column] += rows[row][j] * back[4 * j + column];
      found[16 * k + 4 * row + 3] += own[12 + row];
    }
    found.set(tints(segment), 16 * k + 12);
  });
  eyeballs.forEach((centre, eye) => {
    const way = gaze.slice(3 * eye, 3 * eye + 3);
    const turn = rowsOf(turnAbout(unit(way), Math.hypot(...way)));
    const shift = centre.map((value, j) => value - turn[j].reduce((sum, each, i) => sum + each * centre[i], 0));
    const at = 16 * (bones.length + eye);
    found.copyWithin(at, 16 * head, 16 * head + 16);
    for (let row = 0; row < 3; row++) {
      const own = Array.from(found.subarray(16 * head + 4 * row, 16 * head + 4 * row + 3));
      for (let column = 0; column < 3; column++)
        found[at + 4 * row + column] = own.reduce((sum, value, j) => sum + value * turn[j][column], 0);
      found[at + 4 * row + 3] += own.reduce((sum, value, j) => sum + value * shift[j], 0);
    }
  });
  return found;
};

// How far shapes of the face, each with its weight, move each vertex: three numbers for each.
const faceOf = (shapes, count) => {
  const known = shapes.map(({ step, vertices, moves }) => ({
    step,
    vertices: new Uint16Array(bytesOf(vertices).buffer),
    moves: new Int8Array(bytesOf(moves).buffer),
  }));
  const found = new Float32Array(3 * count);
  return (weights) => {
    found.fill(0);
    known.forEach(({ step, vertices, moves }, k) => {
      const scale = step * weights[k];
      if (scale > 0)
        for (let i = 0; i < vertices.length; i++)
          for (let j = 0; j < 3; j++) found[3 * vertices[i] + j] += scale * moves[3 * i + j];
    });
    return found;
  };
};

// ---- drawing ------------------------------------------------------------------------------------------------

const SKIN = [
  `#version 300 es
  in vec3 place, normal, colour, moved; in float kind; in vec2 mark; in vec4 joints, others, weights, lighter;
  uniform highp sampler2D bones; uniform mat4 view; uniform bool shadow; uniform float unit;
  out vec3 at, n, paint; out vec2 spot; out vec4 glow; flat out int sort;
  void main() {
    vec4 a = vec4(0.0), b = a, c = a, t = a;
    for (int k = 0; k < 8; k++) {
      int bone = int(k < 4 ? joints[k] : others[k - 4]); float share = k < 4 ? weights[k] : lighter[k - 4];
      a += share * texelFetch(bones, ivec2(0, bone), 0); b += share * texelFetch(bones, ivec2(1, bone), 0);
      c += share * texelFetch(bones, ivec2(2, bone), 0); t += share * texelFetch(bones, ivec2(3, bone), 0);
    }
    vec4 p = vec4(place * unit + moved, 1.0); vec3 world = vec3(dot(a, p), dot(b, p), dot(c, p));
    if (shadow) world = vec3(world.xy - vec2(0.4, 0.36) * world.z, 0.002);
    at = world; n = vec3(dot(a.xyz, normal), dot(b.xyz, normal), dot(c.xyz, normal));
    paint = colour; spot = mark; glow = t; sort = int(kind); gl_Position = view * vec4(world, 1.0);
  }`,
  `#version 300 es
  precision highp float; in vec3 at, n, paint; in vec2 spot; in vec4 glow; flat in int sort; uniform float alpha, border;
  uniform vec3 eye, iris, white; uniform bool shadow; out vec4 drawn;
  void main() {
    float past = spot.x * border;
    if (sort == 1 && past > 0.0) discard;
    if (shadow) { drawn = vec4(0.0, 0.0, 0.0, alpha); return; }
    vec3 m = normalize(n) * (gl_FrontFacing ? 1.0 : -1.0), to = normalize(eye - at), sun = normalize(vec3(0.5, 0.45, 0.8));
    vec3 base = paint; float shine = 0.05;
    if (sort == 1) { base *= (past > -0.006 ? 0.86 : 1.0) * (gl_FrontFacing ? 1.0 : 0.4); shine = 0.0; }
    if (sort == 2) {
      float r = length(spot);
      base = mix(mix(vec3(0.03), iris * (r > 0.34 ? 0.6 : 1.0), smoothstep(0.16, 0.19, r)), white, smoothstep(0.39, 0.43, r));
      shine = 0.5;
    }
    base = mix(base, glow.rgb / max(glow.a, 1e-4), glow.a);
    float light = 0.60 + 0.14 * m.z + 0.40 * max(dot(m, sun), 0.0) + 0.12 * max(dot(m, normalize(vec3(0.6, -0.7, 0.2))), 0.0);
    float gloss = shine * pow(max(dot(m, normalize(sun + to)), 0.0), 24.0), rim = 0.06 * pow(1.0 - max(dot(m, to), 0.0), 3.0);
    drawn = vec4((base * light + gloss + rim) * alpha, alpha);
  }`,
];

// `shapes`: of the face, if it moves.
const skinOf = (gl, skin, program, shapes = []) => {
  const { made, at } = program(SKIN);
  const own = gl.createVertexArray();
  gl.bindVertexArray(own);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  const vertices = bytesOf(skin.vertices);
  gl.bufferData(gl.ARRAY_BUFFER, vertices, gl.STATIC_DRAW);
  for (const [name, count, kind, normalised, offset] of [
    ["place", 3, gl.SHORT, false, 0],
    ["normal", 3, gl.BYTE, true, 8],
    ["kind", 1, gl.BYTE, false, 11],
    ["colour", 3, gl.UNSIGNED_BYTE, true, 12],
    ["mark", 2, gl.SHORT, true, 16],
    ["joints", 4, gl.UNSIGNED_BYTE, false, 20],
    ["others", 4, gl.UNSIGNED_BYTE, false, 24],
    ["weights", 4, gl.UNSIGNED_BYTE, true, 28],
    ["lighter", 4, gl.UNSIGNED_BYTE, true, 32],
  ]) {
    const place = gl.getAttribLocation(made, name);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, count, kind, normalised, skin.size, offset);
  }
  const face = faceOf(shapes, vertices.length / skin.size);
  const moved = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, moved);
  gl.enableVertexAttribArray(gl.getAttribLocation(made, "moved"));
  gl.vertexAttribPointer(gl.getAttribLocation(made, "moved"), 3, gl.FLOAT, false, 12, 0);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  const corners = bytesOf(skin.triangles);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);

  return ({ frames, angles, features: shown, tints, view, eye, alpha, shadow }) => {
    gl.useProgram(made);
    gl.bindVertexArray(own);
    gl.bindBuffer(gl.ARRAY_BUFFER, moved);
    gl.bufferData(gl.ARRAY_BUFFER, face(shown?.weights ?? shapes.map(() => 0)), gl.STREAM_DRAW);
    const rows = bonesOf(skin, frames, angles, { tints, gaze: shown?.gaze });
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 4, rows.length / 16, 0, gl.RGBA, gl.FLOAT, rows);
    gl.uniformMatrix4fv(at("view"), false, view);
    gl.uniform3fv(at("eye"), eye);
    gl.uniform3fv(at("iris"), skin.eyes[0]);
    gl.uniform3fv(at("white"), skin.eyes[1]);
    gl.uniform1f(at("unit"), skin.step);
    gl.uniform1f(at("border"), skin.border);
    gl.uniform1f(at("alpha"), alpha);
    gl.uniform1i(at("shadow"), shadow ? 1 : 0);
    gl.drawElements(gl.TRIANGLES, corners.length / 2, gl.UNSIGNED_SHORT, 0);
    gl.bindVertexArray(null);
  };
};
