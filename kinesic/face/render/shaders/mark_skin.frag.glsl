// Marks uneven skin, where light scatters. Elsewhere scattering would change nothing.
uniform sampler2D colour;

in vec2 uv;

void main() {
    if (textureLod(colour, uv, 0.0).a == 0.0) discard;
}
