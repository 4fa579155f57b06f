// What is behind the head.
uniform vec3 backdrop;

in vec2 uv;

out vec4 behind;

vec3 encoded(vec3 light) {
    vec3 a = sqrt(light), b = sqrt(a), c = sqrt(b);
    return 0.585122381 * a + 0.783140355 * b - 0.368262736 * c;
}

void main() {
    vec2 from = uv - vec2(0.5, 0.55);
    vec3 light = backdrop * (1.25 - 1.3 * dot(from, from));
    behind = vec4(encoded(light * (1.0 + light * 0.12) / (1.0 + light * 0.35)), 1.0);
}
