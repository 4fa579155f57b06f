// G-buffer of locks of hair with strands that bend the normal.
uniform vec3 colour;

in vec3 facing;
in vec4 placed;  // across -1..1, along 0..1, number of the lock, brightness
flat in float kind;

const float STRANDS = 7.0;  // strands on each half of a lock
const float FINE = 2.5;     // hairs across a strand
const float RAGGED_ROOT = 0.04, RAGGED_TIP = 0.22;  // largest fraction of a lock that a strand lacks at its ends

layout(location = 0) out vec4 form;
layout(location = 1) out vec4 place;  // square root of the linear colour; gloss

float noise(float x, float y) { return fract(52.9829189 * fract(dot(vec2(floor(x), y), vec2(0.06711056, 7.583715)))); }

void main() {
    float across = placed.x * STRANDS, dense = fwidth(across);
    float strand = noise(across, placed.z), fine = clamp(1.6 - dense, 0.0, 1.0);
    float missing = mix(0.5, noise(across, placed.z + 0.37), clamp(2.0 - 2.0 * dense, 0.0, 1.0));
    if (placed.y < RAGGED_ROOT * missing || placed.y > 1.0 - RAGGED_TIP * missing) discard;
    float hair = mix(0.5, noise(FINE * across, placed.z), clamp(1.6 - FINE * dense, 0.0, 1.0));
    float uneven = mix(0.5, 0.65 * strand + 0.35 * hair, fine);
    vec2 aside = vec2(dFdx(placed.x), dFdy(placed.x));
    float length_of = max(length(aside), 1e-6), inside = fract(across) - 0.5;
    vec3 n = normalize(gl_FrontFacing ? facing : -facing) + vec3(aside / length_of, 0.0) * fine * (0.9 * inside + 0.7 * (strand - 0.5));
    float bright = placed.w * (0.78 + 0.44 * uneven) * mix(0.6, 1.1, smoothstep(0.0, 0.35, placed.y)) * (gl_FrontFacing ? 1.0 : 0.6);
    form = vec4(normalize(n), -1.0 / gl_FragCoord.w - APART * kind);
    place = vec4(sqrt(colour * bright), 0.55);
}
