// G-buffer of clothes: discarded beyond the border, with a seam along it, and darker inside.
in vec3 facing;
in vec4 placed;  // square root of the linear colour; gloss
flat in float kind;
in float detail;  // [m] distance beyond the border

const float SEAM = 0.007;  // [m]

layout(location = 0) out vec4 form;
layout(location = 1) out vec4 place;

void main() {
    if (detail > 0.0) discard;
    vec3 n = normalize(facing);
    float shade = (gl_FrontFacing ? 1.0 : 0.75) * (detail > -SEAM ? 0.9 : 1.0);
    form = vec4(gl_FrontFacing ? n : -n, -1.0 / gl_FragCoord.w - APART * kind);
    place = vec4(placed.rgb * shade, gl_FrontFacing ? placed.a : 0.0);
}
