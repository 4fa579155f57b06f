// The G-buffer of what light shines through: only every so many pixels of it, so that others show what is behind.
in vec3 seen;
in vec3 facing;
in vec4 placed;  // square root of the linear colour; how much it shines
flat in float part;
in float detail;  // how much of it is there

out vec4 position;
out vec4 normal;
out vec4 place;

void main() {
    if (hole(detail)) discard;
    position = vec4(seen, part + 1.0);
    normal = vec4(normalize(facing), part + 1.0);
    place = placed;
}
