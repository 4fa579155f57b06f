// Vertices of the head: current position, and position on the head at rest.
uniform mat4 view;
uniform mat4 projection;

in vec3 position;  // [m]
in vec3 normal;
in vec4 place;     // skin: chart a and y, front mask, height over the hairline; eyes: direction at rest
in vec3 strand;    // hair: unit direction from root to tip
in vec2 matter;    // part; position along a lash 0..1, or coverage of a film

out vec3 facing;
out vec4 placed;
out vec3 combed;
flat out float kind;
out float detail;

void main() {
    vec4 at = view * vec4(position, 1.0);
    facing = mat3(view) * normal;
    placed = place;
    combed = mat3(view) * strand;
    kind = matter.x;
    detail = matter.y;
    gl_Position = projection * at;
}
