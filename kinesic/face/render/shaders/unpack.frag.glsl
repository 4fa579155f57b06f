// Position and normal of each pixel, or of the middle pixel of a block.
uniform sampler2D form;
uniform vec2 offset;  // offset to the middle pixel of the block, in texture coordinates
uniform vec2 lens;

in vec2 uv;

layout(location = 0) out vec4 place;  // [m] in the camera's frame; part + 1
layout(location = 1) out vec4 facing;

void main() {
    vec2 there = uv + offset;
    vec4 found = textureLod(form, there, 0.0);
    if (found.w == 0.0) discard;
    place = vec4(position(there, lens, found.w), part(found.w) + 1.0);
    facing = vec4(found.xyz, 0.0);
}
