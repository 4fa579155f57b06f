// Blinn-Phong with three lights that stand with the camera; skin wraps red light round its edges.
uniform sampler2D bent;
uniform sampler2D colour;
uniform sampler2D open;   // to the light around
uniform sampler2D shade;  // how much of the key's light arrives
uniform sampler2D relief;
uniform vec3 towards[3];  // unit, in the frame of the camera: key, fill, rim
uniform vec3 power[3];    // linear light of each
uniform vec2 lens;        // half the screen at a distance of 1
uniform vec3 sky;         // from above
uniform vec3 ground;      // from below
uniform float threshold;  // of openness, over which the surface is even

const float SKIN = 1.0, EYES = 2.0;
const float FURROW = 0.1;  // height of a wrinkle that counts
const float EDGE = 0.02;   // share of the key's light that is neither light nor shadow
const vec3 BLEED = vec3(0.55, 0.10, 0.05);  // light that comes through the skin round a fold
const vec3 SEEP = vec3(0.14, 0.07, 0.06);  // of the key, into its shadow on skin
const vec3 WRAP = vec3(0.30, 0.14, 0.10);

in vec2 uv;

out vec4 diffuse;  // light that has met no colour yet; what is mirrored
out vec4 uneven;   // 1 on skin where light changes from pixel to pixel, so that spreading it shows

float sixteenth(float x) { x *= x; x *= x; x *= x; return x * x; }

void main() {
    vec4 facing = textureLod(bent, uv, 0.0);
    vec3 n = normalize(facing.xyz), eye = normalize(vec3(-(2.0 * uv - 1.0) * lens, 1.0));
    float is_skin = float(facing.w == SKIN), is_eye = float(facing.w == EYES);
    vec3 wrap = WRAP * is_skin, spent = mix(vec3(1.0), 1.0 / ((1.0 + WRAP) * (1.0 + WRAP)), is_skin);
    float around = textureLod(open, uv, 0.0).r;
    vec3 reached = around + BLEED * is_skin * around * (1.0 - around);
    vec3 light = mix(ground, sky, 0.5 + 0.5 * n.y) * reached;
    vec3 gloss = vec3(0.0);
    vec3 key = textureLod(shade, uv, 0.0).rgb;
    for (int k = 0; k < 3; ++k) {
        float toward = dot(n, towards[k]);
        vec3 reach = k == 0 ? mix(key, vec3(1.0), SEEP * is_skin) : vec3(1.0);
        light += power[k] * reach * (0.35 + 0.65 * reached) * max(toward + wrap, 0.0) * spent;
        float half_way = max(dot(n, normalize(towards[k] + eye)), 0.0);
        float wide = sixteenth(half_way), narrow = sixteenth(sixteenth(half_way));
        gloss += power[k] * reach * clamp(6.0 * toward, 0.0, 1.0) * (mix(0.16 * wide, 1.8 * narrow, is_eye));
    }
    float grazing = 1.0 - max(dot(n, eye), 0.0);
    gloss *= textureLod(colour, uv, 0.0).a * around * (1.0 + 2.0 * grazing * grazing * grazing);
    diffuse = vec4(light, dot(gloss, vec3(1.0 / 3.0)));
    bool even = around > threshold && abs(textureLod(relief, uv, 0.0).r) < FURROW && abs(key.r - 0.5) > 0.5 - EDGE;
    uneven = vec4(even || threshold < 0.0 ? 0.0 : is_skin);
}
