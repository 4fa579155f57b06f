// Background behind the head.
uniform vec3 backdrop;

in vec2 uv;

out vec4 behind;

void main() {
    vec2 from = uv - vec2(0.5, 0.55);
    behind = shown(backdrop * (1.25 - 1.3 * dot(from, from)));
}
