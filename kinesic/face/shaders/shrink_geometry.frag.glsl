// A smaller G-buffer: of so many pixels the one in the middle.
uniform sampler2D position;
uniform sampler2D normal;
uniform vec2 offset;  // from the middle of a pixel here to the middle of one there, in texture coordinates

in vec2 uv;

out vec4 place;
out vec4 facing;

void main() {
    vec2 at = uv + offset;
    place = textureLod(position, at, 0.0);
    if (place.w == 0.0) discard;
    facing = vec4(normalize(textureLod(normal, at, 0.0).xyz), 0.0);
}
