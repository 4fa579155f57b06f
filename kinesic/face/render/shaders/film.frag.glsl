// G-buffer of translucent layers with a screen-door mask, so that other pixels show the background.
in vec3 facing;
in vec4 placed;  // square root of the linear colour; gloss
flat in float kind;
in float detail;  // coverage 0..1

layout(location = 0) out vec4 form;
layout(location = 1) out vec4 place;

void main() {
    if (hole(detail)) discard;
    form = vec4(normalize(facing), -1.0 / gl_FragCoord.w - APART * kind);
    place = placed;
}
