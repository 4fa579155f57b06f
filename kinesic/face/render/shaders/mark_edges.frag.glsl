// Marks pixels whose brightness differs from that of neighbours.
uniform sampler2D picture;
uniform vec2 pixel;  // size in texture coordinates

in vec2 uv;

float bright(float x, float y) { return textureLod(picture, uv + vec2(x, y) * pixel, 0.0).a; }

void main() {
    float nw = bright(-1.0, 1.0), ne = bright(1.0, 1.0), sw = bright(-1.0, -1.0), se = bright(1.0, -1.0), own = bright(0.0, 0.0);
    float low = min(own, min(min(nw, ne), min(sw, se))), high = max(own, max(max(nw, ne), max(sw, se)));
    if (high - low <= max(0.04, 0.125 * high)) discard;
}
