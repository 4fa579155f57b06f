// The G-buffer.
const float LASHES = 4.0;
const float STRANDS = 60.0;  // lashes per unit of the chart

in vec3 seen;
in vec3 facing;
in vec4 placed;
flat in float part;
in float detail;

out vec4 position;  // [m] in the frame of the camera; part + 1 (0 is the background)
out vec4 normal;    // unit, outward; of skin how far inside the mouth
out vec4 place;

void main() {
    if (part == LASHES) {
        float across = abs(fract(placed.x * STRANDS + 0.35 * detail) - 0.5);
        float length = placed.y > 0.0 ? 1.0 : 0.6;
        float width = 0.45 * (1.0 - detail / length);
        if (across > width || width < 0.2 * min(fwidth(placed.x * STRANDS), 1.0)) discard;  // no dots where it is thin
    }
    position = vec4(seen, part + 1.0);
    normal = vec4(normalize(facing), detail);
    place = placed;
}
