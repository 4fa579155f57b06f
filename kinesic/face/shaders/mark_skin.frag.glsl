// Marks the skin that light spreads under: where it is uneven. Elsewhere spreading it changes nothing.
uniform sampler2D uneven;

in vec2 uv;

void main() {
    if (textureLod(uneven, uv, 0.0).r < 0.5) discard;
}
