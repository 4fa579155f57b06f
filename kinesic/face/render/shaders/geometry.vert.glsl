// Vertices of the head: where they are now, and where on the head at rest they belong.
uniform mat4 view;
uniform mat4 projection;

in vec3 position;  // [m]
in vec3 normal;
in vec4 place;     // skin: chart a and y, front mask, height over the hairline; eyes: direction at rest
in vec2 matter;    // part; of a lash nearness to the tip, of a film its share

out vec3 facing;
out vec4 placed;
flat out float kind;
out float detail;

void main() {
    vec4 at = view * vec4(position, 1.0);
    facing = mat3(view) * normal;
    placed = place;
    kind = matter.x;
    detail = matter.y;
    gl_Position = projection * at;
}
