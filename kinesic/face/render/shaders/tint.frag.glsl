// Tint of key light through translucent layers, seen from the lamp.
in vec4 placed;
flat in float kind;
in float detail;

const vec3 LASH = vec3(0.10, 0.06, 0.05);

out vec4 tint;

void main() {
    if (hole(kind == LASHES ? 0.7 * (1.0 - detail) : detail)) discard;
    tint = vec4(kind == LASHES ? LASH : placed.rgb * placed.rgb, 1.0);
}
