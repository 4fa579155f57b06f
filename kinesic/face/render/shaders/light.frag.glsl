// Blinn-Phong shading with three lights attached to the camera; red light wraps around edges of skin. If light is to
// scatter, KEPT > 0, and uneven skin is also written to separate textures.
uniform sampler2D bent;   // form with bent normals
uniform sampler2D reach;  // received fractions of key light and of ambient light
uniform sampler2D relief;
uniform vec3 towards[3];  // unit vectors in the camera's frame: key, fill, rim
uniform vec3 power[3];    // linear colours of the lights
uniform vec2 lens;
uniform vec3 sky;         // ambient light from above
uniform vec3 ground;      // ambient light from below
uniform float threshold;  // openness above which a surface counts as even
#if LEVELS > 1
uniform float deep;       // openness below which light scatters with all LEVELS
#endif

const float FURROW = 0.1;  // height from which a wrinkle counts as uneven
const float EDGE = 0.02;   // distance of key light from 0 and 1 that counts as a shadow edge
const float WET = 0.6;     // minimum openness of an eye
const float TEAR_GLOSS = 0.25;  // fraction of the light that the line of tears mirrors
const float TEARS = 0.0005;  // [m] height of the line of tears along a lower lid
const float PORE_HEIGHT = 0.0007;  // [m] height of skin per unit of gloss, which is lower in pores
const float PORE_SLOPE = 0.16;  // steepest side of a pore
const float STEEPEST = 4.0;    // slope of skin from which it shows no pores; edges are steeper
const float FACE = 1.2;    // chart range around the nose, where the mask is low only in the mouth
const float BRIGHT_MOUTH = 0.45;  // minimum light on teeth and tongue
const float BRIGHT_CHEEK = 0.3;   // minimum light on the inside of lips and cheeks
const vec3 BLEED = vec3(0.55, 0.10, 0.05);  // light through the skin around a fold
const vec3 SEEP = vec3(0.14, 0.07, 0.06);  // key light that seeps into its shadow on skin
const vec3 WRAP = vec3(0.30, 0.14, 0.10);

in vec2 uv;

layout(location = 0) out vec4 picture;
#if KEPT
layout(location = 1) out vec4 diffuse;  // light before the surface colour; specular light
layout(location = 2) out vec4 colour;   // square root of the surface colour; scattering level 0..1
#endif

float eighth(float x) { x *= x; x *= x; return x * x; }

void main() {
    vec4 facing = textureLod(bent, uv, 0.0);
    vec3 n = facing.xyz, eye = normalize(vec3(-(2.0 * uv - 1.0) * lens, 1.0));
    float height = textureLod(relief, uv, 0.0).r;
    bool skinned = on_skin(facing.w);
    vec4 own = surface(uv, skinned, height);
    float pixel = 2.0 * lens.y * -depth(facing.w) / float(textureSize(bent, 0).y);  // [m]
    float flat_area = n.z * float(skinned && fwidth(facing.w) < STEEPEST * pixel);
    vec2 pores = flat_area * clamp(PORE_HEIGHT / pixel * vec2(dFdx(own.a), dFdy(own.a)), -PORE_SLOPE, PORE_SLOPE);
    float is_skin = float(skinned);
    bool is_eye = part(facing.w) == EYES;
    float under = textureLod(bent, uv - vec2(0.0, 0.5 * TEARS / (lens.y * -depth(facing.w))), 0.0).w;
    float wet = float(is_eye && on_skin(under));
    vec3 wrap = WRAP * is_skin, spent = mix(vec3(1.0), 1.0 / ((1.0 + WRAP) * (1.0 + WRAP)), is_skin);
    vec4 arrives = textureLod(reach, uv, 0.0);
    bool in_mouth = part(facing.w) == TEETH || part(facing.w) == TONGUE;
    vec4 where = textureLod(place, uv, 0.0);
    float lip = skinned && abs(where.x) < FACE ? clamp(where.z, 0.0, 1.0) : 1.0;
    float least = in_mouth ? BRIGHT_MOUTH : skinned ? BRIGHT_CHEEK * clamp(-where.z, 0.0, 1.0) : 0.0;
    vec3 key = max(arrives.rgb, least);
    float around = max(arrives.a, is_eye ? WET : least);
    vec3 reached = around + BLEED * is_skin * around * (1.0 - around);
    vec3 direct = vec3(0.0);
    float behind = float(!in_mouth) * lip;  // fraction of rim light, which has no shadow map and must not shine through a cheek
    float gloss = 0.0, frontal = dot(n, eye), mirrored = frontal - dot(pores, eye.xy);
    for (int k = 0; k < 3; ++k) {
        vec3 shone = k == 0 ? power[k] * mix(key, vec3(1.0), SEEP * is_skin) : k == 1 ? power[k] : power[k] * behind;
        float toward = dot(n, towards[k]);
        direct += shone * max(toward + wrap, 0.0);
        float shining = toward - dot(pores, towards[k].xy);  // light that enters skin spreads wider than a pore
        float half_way = max(shining + mirrored, 0.0);  // unnormalised cosine to the half vector
        float wide = eighth(half_way * half_way / (2.0 + 2.0 * dot(towards[k], eye))), narrow = eighth(wide * wide);
        gloss += dot(shone, vec3(1.0 / 3.0)) * clamp(6.0 * shining, 0.0, 1.0) * (is_eye ? 2.4 * narrow : 0.16 * wide);
    }
    vec3 light = mix(ground, sky, 0.5 + 0.5 * n.y) * reached + direct * spent;
    float grazing = 1.0 - max(frontal, 0.0);
    gloss *= own.a * (is_eye ? 1.0 : around) * (1.0 + 2.0 * grazing * grazing * grazing);
    vec4 lit = vec4(light, gloss + wet * TEAR_GLOSS * around * dot(light, vec3(1.0 / 3.0)));
    vec3 root = floor(255.0 * own.rgb + 0.5) / 255.0;  // quantised as stored, so that zero scattering changes nothing
    picture = composed(lit, root);
#if KEPT
    bool smooth_skin = abs(height) < FURROW && abs(key.r - 0.5) > 0.5 - EDGE, even = around > threshold && smooth_skin;
    diffuse = lit;
    float level = 1.0;
#if LEVELS > 1
    float asked = ceil(float(LEVELS) * (threshold - around) / (threshold - deep));
    level = smooth_skin ? clamp(asked, 1.0, float(LEVELS)) / float(LEVELS) : 1.0;
#endif
    colour = vec4(root, even || threshold < 0.0 ? 0.0 : is_skin * level);
#endif
}
