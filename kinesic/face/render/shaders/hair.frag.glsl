// G-buffer of locks of hair. Strands vary in colour, bend the normal a little, and mirror the lamp along their direction
// (J. T. Kajiya and T. L. Kay, 1989); the mirrored light is part of the colour, so that shadows dim it.
uniform vec3 colour;
uniform vec3 half_way;  // unit vector between the directions to lamp and viewer, in the camera's frame

in vec3 facing;
in vec3 combed;
in vec4 placed;  // across -1..1, along 0..1, number of the lock, brightness
flat in float kind;

const float STRANDS = 9.0;  // strands on each half of a lock
const float FINE = 3.0;     // hairs across a strand
const float RAGGED_ROOT = 0.16, RAGGED_TIP = 0.42;  // largest fraction of a lock that a strand lacks at its ends
const float LOOSE = 0.45;   // fraction of the width of a lock at whose sides strands are missing
const float BEND = 0.45;    // tilt of the normal at the side of a strand
const vec3 MIRRORED = vec3(0.075, 0.062, 0.052);  // reflection at the surface of strands
const float INNER = 0.9;    // reflection inside strands, relative to their colour
const float SPREAD = 0.16;  // variation of the direction in which strands mirror

layout(location = 0) out vec4 form;
layout(location = 1) out vec4 place;  // square root of the linear colour; gloss

float noise(float x, float y) { return fract(52.9829189 * fract(dot(vec2(floor(x), y), vec2(0.06711056, 7.583715)))); }

void main() {
    float across = placed.x * STRANDS, dense = fwidth(across);
    float strand = noise(across, placed.z), fine = clamp(1.6 - dense, 0.0, 1.0);
    float missing = mix(0.5, noise(across, placed.z + 0.37), clamp(2.0 - 2.0 * dense, 0.0, 1.0));
    if (placed.y < RAGGED_ROOT * missing || placed.y > 1.0 - RAGGED_TIP * missing) discard;
    if (abs(placed.x) > 1.0 - LOOSE * missing * placed.y) discard;
    float hair = mix(0.5, noise(FINE * across, placed.z), clamp(1.6 - FINE * dense, 0.0, 1.0));
    float uneven = mix(0.5, 0.55 * strand + 0.45 * hair, fine);
    vec2 aside = vec2(dFdx(placed.x), dFdy(placed.x));
    float length_of = max(length(aside), 1e-6), inside = fract(across) - 0.5;
    vec3 n = normalize(gl_FrontFacing ? facing : -facing);
    float along = dot(normalize(combed), half_way) + SPREAD * (uneven - 0.5) - 0.06;
    float ring = max(1.0 - along * along, 0.0), wide = ring * ring, wider = along + 0.16;
    wide *= wide; wide *= wide; wide *= wide;
    float deep = max(1.0 - wider * wider, 0.0); deep *= deep; deep *= deep;
    n += vec3(aside / length_of, 0.0) * fine * BEND * (inside + 0.6 * (strand - 0.5));
    float bright = placed.w * (0.62 + 0.6 * uneven) * mix(0.75, 1.1, smoothstep(0.0, 0.35, placed.y)) * (gl_FrontFacing ? 1.0 : 0.6);
    vec3 shine = gl_FrontFacing ? (MIRRORED * wide * wide + INNER * colour * deep) * (0.5 + uneven) : vec3(0.0);
    form = vec4(normalize(n), -1.0 / gl_FragCoord.w - APART * kind);
    place = vec4(sqrt(colour * bright + shine), 0.12);
}
