// Marks the skin that light spreads under: where it is uneven. Elsewhere spreading it changes nothing.
uniform sampler2D colour;

in vec2 uv;

void main() {
    if (textureLod(colour, uv, 0.0).a == 0.0) discard;
}
