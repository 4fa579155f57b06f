// Draws the robot in its skin, its shell or else its capsules, with WebGL, at given angles, and a ghost of it beside or over it.
// Where it is not smooth it is for software that draws: edges are not.
const sceneOf = (canvas, data, smooth = true) => {
  const gl = canvas.getContext("webgl2", { alpha: true, antialias: smooth, stencil: true });
  if (!gl) return null;

  // ---- frames: 4 x 4 matrices, columns first ------------------------------------------------------------------

  const product = (a, b) => {
    const out = new Float32Array(16);
    for (let column = 0; column < 4; column++)
      for (let row = 0; row < 4; row++)
        for (let k = 0; k < 4; k++) out[4 * column + row] += a[4 * k + row] * b[4 * column + k];
    return out;
  };
  const shifted = ([x, y, z]) => new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1]);
  const turned = ([x, y, z], angle) => {
    const c = Math.cos(angle);
    const s = Math.sin(angle);
    const v = 1 - c;
    return new Float32Array([
      c + x * x * v, y * x * v + z * s, z * x * v - y * s, 0,
      x * y * v - z * s, c + y * y * v, z * y * v + x * s, 0,
      x * z * v + y * s, y * z * v - x * s, c + z * z * v, 0,
      0, 0, 0, 1,
    ]);
  };
  const frames = (angles, base) =>
    data.segments.reduce((found, segment) => {
      let frame = product(segment.parent < 0 ? base : found[segment.parent], shifted(segment.origin));
      for (const { hinge, axis, at, ratio = 1, offset = 0 } of segment.hinges)
        frame = product(
          product(frame, shifted(at)),
          product(turned(axis, offset + ratio * angles[hinge]), shifted(at.map((value) => -value))),
        );
      return [...found, frame];
    }, []);

  const onto = (segment, k) => ({
    segment: k,
    hinges: segment.hinges.map(({ hinge }) => hinge),
    colour: segment.colour,
  });
  const bare = () => [
    ...data.segments.flatMap((segment, k) =>
      segment.capsules.map((ends) => ({ ...onto(segment, k), mesh: capsule(ends) })),
    ),
    ...data.servos.map((servo) => ({
      segment: servo.segment,
      hinges: [servo.hinge],
      colour: "servo",
      mesh: box(servo.at, servo.half),
    })),
  ];
  // The housing of a segment is as hot as the hinges that turn it, its dark parts as the servos that sit in it.
  const clothed = () =>
    data.shells.flatMap(({ segment, colour, ...packed }) => {
      const { mesh, shell, joint } = surface(packed, data.shell_step);
      const inside = data.servos.filter((servo) => servo.segment === segment).map(({ hinge }) => hinge);
      return [
        { ...onto(data.segments[segment], segment), colour, mesh, corners: shell },
        { segment, hinges: inside, colour: "servo", mesh, corners: joint },
      ];
    });
  const shapes = [
    ...(data.shells.length ? clothed() : bare()),
    ...data.details.map((detail) => ({
      segment: detail.segment,
      hinges: [],
      colour: detail.colour,
      mesh: capsule(detail.capsule),
    })),
    ...(data.screen ? [{ segment: data.screen.segment, hinges: [], colour: "frame", mesh: cornersOf(data.screen.frame) }] : []),
  ];

  const COLOURS = {
    trunk: [0.34, 0.42, 0.52],
    limb: [0.93, 0.92, 0.89],
    l_hand: [0.95, 0.55, 0.22],
    r_hand: [0.16, 0.56, 0.66],
    white: [1, 1, 1],
    pupil: [0.06, 0.07, 0.1],
    servo: [0.17, 0.18, 0.21],
    frame: [0.09, 0.1, 0.12],
    hot: [0.91, 0.16, 0.12],
    lit: [1, 0.72, 0.1],
  };
  const heated = (colour, duty) =>
    colour.map((value, k) => value + (COLOURS.hot[k] - value) * 0.85 * Math.min(Math.max(2 * duty - 1, 0), 1));

  // ---- drawing ------------------------------------------------------------------------------------------------

  const LIGHT = `vec3 lighted(vec3 paint, vec3 n, vec3 way) {
      vec3 m = normalize(n), to = normalize(way), sun = normalize(vec3(0.5, 0.45, 0.8));
      float light = 0.46 + 0.14 * m.z + 0.46 * max(dot(m, sun), 0.0) + 0.12 * max(dot(m, normalize(vec3(0.6, -0.7, 0.2))), 0.0);
      float gloss = 0.16 * pow(max(dot(m, normalize(sun + to)), 0.0), 36.0), rim = 0.10 * pow(1.0 - max(dot(m, to), 0.0), 3.0);
      return paint * light + gloss + rim;
    }`;
  const SOLID = [
    `#version 300 es
    in vec3 place; in vec3 normal; uniform mat4 frame, view; uniform bool shadow; out vec3 at, n;
    void main() {
      vec4 world = frame * vec4(place, 1.0);
      if (shadow) world.xyz = vec3(world.xy - vec2(0.4, 0.36) * world.z, 0.002);
      at = world.xyz; n = mat3(frame) * normal; gl_Position = view * world;
    }`,
    `#version 300 es
    precision highp float; in vec3 at, n; uniform vec4 colour; uniform vec3 eye; uniform bool shadow; out vec4 drawn;
    ${LIGHT}
    void main() {
      drawn = vec4(shadow ? vec3(0.0) : lighted(colour.rgb, n, eye - at) * colour.a, colour.a);
    }`,
  ];
  const FLOOR = [
    `#version 300 es
    in vec3 place; uniform mat4 view; uniform float reach; out vec2 at;
    void main() { at = place.xy * reach; gl_Position = view * vec4(at, 0.0, 1.0); }`,
    `#version 300 es
    precision highp float; in vec2 at; uniform vec3 ink; uniform float reach; out vec4 drawn;
    void main() {
      vec2 cell = abs(fract(at / 0.25 - 0.5) - 0.5) / fwidth(at / 0.25);
      float line = 1.0 - min(min(cell.x, cell.y), 1.0), fade = 1.0 - smoothstep(0.25 * reach, reach, length(at));
      float alpha = (0.05 + 0.16 * line) * fade; drawn = vec4(ink * alpha, alpha);
    }`,
  ];
  const program = ([vertex, fragment]) => {
    const made = gl.createProgram();
    for (const [kind, source] of [
      [gl.VERTEX_SHADER, vertex],
      [gl.FRAGMENT_SHADER, fragment],
    ]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    }
    gl.bindAttribLocation(made, 0, "place");
    gl.bindAttribLocation(made, 1, "normal");
    gl.bindAttribLocation(made, 2, "share");
    gl.linkProgram(made);
    const known = {};
    return { made, at: (name) => (known[name] ??= gl.getUniformLocation(made, name)) };
  };

  let solid, ground, skin, screen;
  const prepare = () => {
    solid = program(SOLID);
    ground = program(FLOOR);
    skin = data.skin && skinOf(gl, data.skin, program, data.features?.shapes);
    screen = data.screen && screenOf(gl, data.screen, program);
    const vertices = [-1, -1, 0, 0, 0, 1, 1, -1, 0, 0, 0, 1, -1, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 1];
    const corners = [];
    const begins = new Map(); // mesh -> its first vertex; two shapes may share one
    for (const { mesh } of shapes) {
      if (begins.has(mesh)) continue;
      begins.set(mesh, vertices.length / 6);
      for (const value of mesh) vertices.push(value);
    }
    for (const shape of shapes) {
      const begin = begins.get(shape.mesh);
      const size = shape.corners ? shape.corners.length : shape.mesh.length / 6;
      shape.first = corners.length;
      shape.size = size;
      for (let k = 0; k < size; k++) corners.push(begin + (shape.corners ? shape.corners[k] : k));
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(corners), gl.STATIC_DRAW);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(vertices), gl.STATIC_DRAW);
    for (const [attribute, offset] of [
      [0, 0],
      [1, 12],
    ]) {
      gl.enableVertexAttribArray(attribute);
      gl.vertexAttribPointer(attribute, 3, gl.FLOAT, false, 24, offset);
    }
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  };

  const REACH = 1.6; // [m] of the floor
  const SPREAD = 0.78 * data.view.height; // [m] between twin and ghost
  const UP = [0, 0, -data.view.floor]; // from the world to the picture, whose floor is at 0
  const MIDDLE = add(data.view.middle, UP);

  const camera = (look, middle, tall, aspect) => {
    const field = (28 * Math.PI) / 180;
    const away = tall / 2 / Math.tan(field / 2) / look.zoom;
    const back = [
      Math.cos(look.rise) * Math.cos(look.turn),
      Math.cos(look.rise) * Math.sin(look.turn),
      Math.sin(look.rise),
    ];
    const eye = add(middle, back, away);
    const right = unit(cross([0, 0, 1], back));
    const up = cross(back, right);
    const near = away / 20;
    const far = away * 20;
    const f = 1 / Math.tan(field / 2);
    const seen = new Float32Array([
      right[0], up[0], back[0], 0,
      right[1], up[1], back[1], 0,
      right[2], up[2], back[2], 0,
      -dot(right, eye), -dot(up, eye), -dot(back, eye), 1,
    ]);
    const lens = new Float32Array([
      f / aspect, 0, 0, 0,
      0, f, 0, 0,
      0, 0, (far + near) / (near - far), -1,
      0, 0, (2 * far * near) / (near - far), 0,
    ]);
    return { eye, view: product(lens, seen) };
  };

  // The camera of a look: the whole robot is seen, or two of them side by side.
  const cameraOf = (look, beside = false, shape = canvas) => {
    const across = beside ? 1.8 : 0.9; // shares of the height that must be seen
    const aspect = shape.width / shape.height;
    return camera(look, MIDDLE, data.view.height * Math.max(1, across / aspect), aspect);
  };

  const FINE = () => Math.min(window.devicePixelRatio || 1, 2);
  const draw = ({ look, twin, ghost, beside, ink, lit, face, scale = FINE(), full = true }) => {
    const width = Math.round(canvas.clientWidth * scale);
    const height = Math.round(canvas.clientHeight * scale);
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const spread = beside ? SPREAD : 0;
    const { eye, view } = cameraOf(look, beside);
    const aside = [(-Math.sin(look.turn) * spread) / 2, (Math.cos(look.turn) * spread) / 2, 0];
    const seen = { view, eye };
    const solidBody = {
      ...seen,
      angles: twin.angles,
      features: twin.features,
      frames: frames(twin.angles, shifted(add(UP, aside, -1))),
      duty: twin.duty,
      lit,
      alpha: 1,
    };
    const ghostBody = ghost && {
      ...seen,
      angles: ghost,
      frames: frames(ghost, shifted(add(UP, aside))),
      alpha: beside ? 0.5 : 0.38,
    };
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.useProgram(ground.made);
    gl.uniformMatrix4fv(ground.at("view"), false, view);
    gl.uniform1f(ground.at("reach"), REACH);
    gl.uniform3fv(ground.at("ink"), ink);
    gl.depthMask(false);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    if (full) cast([solidBody, ghostBody].filter(Boolean));
    gl.depthMask(true);
    body(solidBody);
    screen?.(solidBody.frames[data.screen.segment], view, face);
    if (ghostBody) {
      gl.colorMask(false, false, false, false);
      body(ghostBody);
      gl.colorMask(true, true, true, true);
      body(ghostBody);
    }
    return [add(MIDDLE, aside, -1), add(MIDDLE, aside)].map((place) => above(place, view));
  };

  const cast = (bodies) => {
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    gl.useProgram(solid.made);
    gl.uniform1i(solid.at("shadow"), 1);
    for (const one of bodies) body({ ...one, alpha: 0.16 * one.alpha, shadow: true });
    gl.useProgram(solid.made);
    gl.uniform1i(solid.at("shadow"), 0);
    gl.disable(gl.STENCIL_TEST);
  };

  const body = (one) => {
    if (!skin) return rigid(one);
    skin({ ...one, tints: (segment) => tint(segment, one) });
  };
  // What the skin of a segment is coloured with, and how much: where it is lit, or its drives are strained.
  const tint = (segment, { duty, lit }) => {
    if (lit?.has(segment)) return [...COLOURS.lit, 1];
    const strain = duty ? Math.max(0, ...data.segments[segment].hinges.map(({ hinge }) => duty[hinge])) : 0;
    const share = 0.85 * Math.min(Math.max(2 * strain - 1, 0), 1);
    return [...COLOURS.hot.map((value) => value * share), share];
  };

  const paint = (shape, { duty, lit }) => {
    const strain = duty ? Math.max(0, ...shape.hinges.map((hinge) => duty[hinge])) : 0;
    return heated(COLOURS[lit?.has(shape.segment) ? "lit" : shape.colour], strain);
  };
  const rigid = (one) => {
    const { made, at } = solid;
    gl.useProgram(made);
    gl.uniformMatrix4fv(at("view"), false, one.view);
    gl.uniform3fv(at("eye"), one.eye);
    for (const shape of shapes) {
      gl.uniformMatrix4fv(at("frame"), false, one.frames[shape.segment]);
      gl.uniform4f(at("colour"), ...paint(shape, one), one.alpha);
      gl.drawElements(gl.TRIANGLES, shape.size, gl.UNSIGNED_INT, 4 * shape.first);
    }
  };

  // Where on the canvas, in percent, the place above a robot is.
  const above = ([x, y, z], view) => {
    const top = z + 0.37 * data.view.height;
    const seen = (row) => view[row] * x + view[row + 4] * y + view[row + 8] * top + view[row + 12];
    return [50 + (50 * seen(0)) / seen(3), 50 - (50 * seen(1)) / seen(3)];
  };

  prepare();
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", prepare);
  return {
    draw,
    camera: (look, shape) => cameraOf(look, false, shape),
    frames: (angles) => frames(angles, shifted(UP)),
    up: UP,
    shapes: skin ? null : shapes,
    paint,
  };
};
