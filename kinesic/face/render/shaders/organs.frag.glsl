// G-buffer of eyes, teeth and tongue, with their colours.
uniform sampler2D iris;  // painted around the axis of an eye
uniform mat4 view;
uniform float pupil;     // radius in radii of the eyeball
uniform mat3 balls[2];   // axes of left and right eyeball in the camera's frame: forward, left, up

in vec3 facing;
in vec4 placed;
flat in float kind;
in float detail;  // 1 for the right eye

const float IRIS = 0.8;    // half width of the painting, in radii of the eyeball
const float LIMBUS = 0.4, PUPIL = 0.17;  // radii of iris and pupil in the painting
const float CORNEA = 0.2742;  // square of CORNEA_ANGLE; BULGE is CORNEA_HEIGHT in eyeball.py
const float BULGE = 0.05;
const float SUNKEN = 0.12; // apparent depth of the iris behind the cornea
const float DAMP = 0.2;    // gloss of the white of the eye
const vec3 GUMS = vec3(0.42, 0.12, 0.11), IVORY = vec3(0.80, 0.74, 0.64), TONGUE_RED = vec3(0.58, 0.20, 0.19);
const vec3 TONGUE_COAT = vec3(0.84, 0.48, 0.43);
const vec3 THROAT = vec3(0.032, 0.008, 0.007);  // equal to the dark skin in the throat
const vec3 WALLS = vec3(1.0, 0.66, 0.58);  // tint of light from cheeks and palate
const vec3 CARUNCLE = vec3(0.66, 0.29, 0.25), PLICA = vec3(0.70, 0.46, 0.42);  // flesh in the inner corner, and the fold before it
const float LEVEL = 0.85;  // removed fraction of vertical normals, since the mesh turns over at the cutting edge
const float INNER = 3.0;  // [mm] by which a crown is shorter on the tongue's side
const int TEETH_ON_A_SIDE = 7;
const float UPPER[TEETH_ON_A_SIDE] = float[](8.6, 6.6, 7.6, 7.0, 7.0, 10.0, 10.0);  // [mm] widths of the upper teeth
const float LOWER[TEETH_ON_A_SIDE] = float[](5.4, 5.9, 6.8, 7.0, 7.0, 11.0, 11.0);
const float CROWN[TEETH_ON_A_SIDE] = float[](10.4, 9.6, 10.8, 10.0, 9.4, 8.6, 8.0);  // [mm] heights of the crowns
const float WORN[TEETH_ON_A_SIDE] = float[](0.0, 0.8, 0.1, 0.7, 0.9, 1.0, 1.0);     // [mm] distance of a tooth from the edge of the row
const float TONE[TEETH_ON_A_SIDE] = float[](1.0, 0.97, 0.88, 0.92, 0.90, 0.87, 0.87);  // brightness; canines are darker
const vec3 ROOT = vec3(0.90, 0.78, 0.62);   // tint of a tooth near the gums, where dentine shines through
const vec3 EDGE = vec3(0.80, 0.86, 0.92);   // tint of the translucent enamel at the cutting edge
const vec3 GAP = vec3(0.24, 0.11, 0.08);    // colour between two teeth
const float BITE = 0.6;   // brightness of the edges of lower teeth, which upper teeth shade

layout(location = 0) out vec4 form;
layout(location = 1) out vec4 place;  // square root of the linear colour; gloss

// Position in the painting; the iris contracts as the pupil widens.
vec2 stretched(vec2 at) {
    float away = max(length(at), 1e-6);
    float outer = PUPIL + (away - pupil) * (LIMBUS - PUPIL) / (LIMBUS - pupil);
    return at / away * (away < pupil ? away * PUPIL / pupil : away < LIMBUS ? outer : away);
}

// Colour of an eye; the cornea bends its normal.
vec4 eye(mat3 ball, inout vec3 n) {
    float nasal = dot(n, mat3(view)[1]) * (detail > 0.5 ? 1.0 : -1.0);
    vec3 own = n * ball, head = n * mat3(view), seen = vec3(0.0, 0.0, 1.0) * ball;
    float short_of = 1.0 - own.x, inside = max(1.0 - short_of * (2.0 + short_of / 3.0) / CORNEA, 0.0);
    n = normalize(n + 4.0 * BULGE / CORNEA * inside * (n - ball[0] * own.x));
    float lid = 1.0 - 0.45 * smoothstep(0.05, 0.5, head.z) - 0.25 * smoothstep(0.4, 0.8, abs(head.y));
    vec3 paint = textureLod(iris, stretched(own.yz - SUNKEN * inside * seen.yz) / IRIS * 0.5 + 0.5, 0.0).rgb;
    float fold = smoothstep(0.38, 0.52, nasal) * (1.0 - inside), flesh = smoothstep(0.52, 0.57, nasal + 0.5 * head.z * head.z);
    paint = mix(mix(paint * lid, PLICA, 0.6 * fold), CARUNCLE, flesh);
    vec3 inward = mat3(view)[1] * (detail > 0.5 ? 1.0 : -1.0);
    n = normalize(n + flesh * (2.0 * (nasal - 0.60) * inward + 0.25 * mat3(view)[2]));
    return vec4(paint, mix(DAMP, 1.0, max(inside, 0.3 * flesh)));
}

// Colour and gloss of teeth and gums. Each tooth bulges; gaps between edges are discarded.
vec4 teeth(inout vec3 n) {
    float from = abs(placed.x);
    bool upper = placed.w > 0.0;
    int k = 0;
    for (; k + 1 < TEETH_ON_A_SIDE && from >= (upper ? UPPER[k] : LOWER[k]); ++k) from -= upper ? UPPER[k] : LOWER[k];
    float wide = upper ? UPPER[k] : LOWER[k], crown = CROWN[k] - (upper ? 0.0 : 1.0);
    float u = clamp(2.0 * from / wide - 1.0, -1.0, 1.0), round_off = 1.5 * u * u * u * u;
    if (placed.y >= 0.0 && placed.y < 0.5 * WORN[k] + round_off) discard;
    float gum = smoothstep(-0.35, 0.35, (placed.y < 0.0 ? INNER - placed.y : placed.y) - crown + 1.3 * u * u);
    float between = smoothstep(0.78, 1.0, abs(u)) * (1.0 - gum);
    vec3 up = mat3(view)[2], aside = normalize(cross(up, n)) * sign(placed.x);
    n -= LEVEL * dot(n, up) * up;
    n = normalize(n + (1.0 - gum) * (0.5 * u * abs(u) * aside - 0.25 * sign(placed.w) * (placed.y / crown - 0.5) * up));
    vec3 ivory = IVORY * TONE[k] * mix(vec3(1.0), ROOT, smoothstep(0.25, 1.0, placed.y / crown)) * mix(EDGE, vec3(1.0), smoothstep(0.3, 2.4, placed.y));
    ivory *= upper ? 1.0 : mix(BITE, 1.0, smoothstep(0.0, 2.0, placed.y));
    vec3 colour = mix(mix(ivory, GAP, 0.6 * between), GUMS * (1.0 - 0.35 * smoothstep(2.0, 6.0, placed.y - crown)), gum);
    float light = smoothstep(-0.15, 0.44, placed.z) * (placed.y < 0.0 ? 0.55 : 1.0);
    return vec4(mix(THROAT, colour * mix(WALLS, vec3(1.0), light), light), (1.0 - gum * 0.4) * light);
}

// Colour and gloss of the tongue: red at its sides, coated and rough on its back, with a groove.
vec4 tongue(inout vec3 n) {
    vec3 up = mat3(view)[2];
    float light = smoothstep(-0.45, 0.15, placed.z), groove = exp(-placed.x * placed.x / 0.0025) * smoothstep(0.35, -0.1, placed.z);
    float coat = smoothstep(0.1, 0.7, dot(n, up)) * smoothstep(0.30, 0.10, abs(placed.x));
    vec2 bumps = sin(vec2(placed.x, placed.z) * 340.0 + 3.0 * sin(vec2(placed.z, placed.x) * 130.0));
    n = normalize(n + 0.06 * coat * vec3(bumps, 0.0));
    vec3 colour = mix(TONGUE_RED, TONGUE_COAT, coat * (0.9 + 0.1 * bumps.x * bumps.y)) * (1.0 - 0.30 * groove);
    return vec4(mix(THROAT, colour, light), 0.6 * light);
}

void main() {
    vec3 n = normalize(facing);
    vec4 paint = kind == EYES ? eye(detail > 0.5 ? balls[1] : balls[0], n) : kind == TEETH ? teeth(n) : tongue(n);
    form = vec4(n, -1.0 / gl_FragCoord.w - APART * kind);
    place = vec4(sqrt(paint.rgb), paint.a);
}
