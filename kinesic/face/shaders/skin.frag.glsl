// The G-buffer of the skin.
in vec3 seen;
in vec3 facing;
in vec4 placed;

const float SKIN = 1.0;

out vec4 position;  // [m] in the frame of the camera; part + 1 (0 is the background)
out vec4 normal;    // unit, outward; part + 1
out vec4 place;     // in the chart, front mask or minus how far inside the mouth, height over the hairline

void main() {
    position = vec4(seen, SKIN);
    normal = vec4(normalize(facing), SKIN);
    place = placed;
}
