// The G-buffer of what light shines through: only every so many pixels of it, so that others show what is behind.
in vec3 facing;
in vec4 placed;  // square root of the linear colour; how much it shines
flat in float kind;
in float detail;  // how much of it is there

layout(location = 0) out vec4 form;
layout(location = 1) out vec4 place;

void main() {
    if (hole(detail)) discard;
    form = vec4(normalize(facing), -1.0 / gl_FragCoord.w - APART * kind);
    place = placed;
}
