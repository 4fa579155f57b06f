// Blinn-Phong with three lights that stand with the camera; skin wraps red light round its edges.
uniform sampler2D position;
uniform sampler2D bent;
uniform sampler2D colour;
uniform sampler2D open;   // to the light around
uniform vec3 towards[3];  // unit, in the frame of the camera: key, fill, rim
uniform vec3 power[3];    // linear light of each
uniform vec2 size;
uniform vec3 sky;         // from above
uniform vec3 ground;      // from below

const float SKIN = 1.0, EYES = 2.0;
#if SHADOW
uniform sampler2DShadow shade;  // depths from the key
uniform mat4 lamp;              // to its clip space

const float LIFT = 0.002;    // [m] off the surface, so that it does not shade itself
const float BIAS = 0.003;
const float SOFT = 0.0035;   // [share of the map] between samples

// How much of the key reaches a point.
float lit(vec3 point, vec3 n) {
    vec3 at = (lamp * vec4(point + LIFT * n, 1.0)).xyz * 0.5 + 0.5;
    float sum = 0.0;
    for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) sum += texture(shade, vec3(at.xy + SOFT * vec2(i, j), at.z - BIAS));
    return sum / 9.0;
}
#else
float lit(vec3 point, vec3 n) { return 1.0; }
#endif

const vec3 BLEED = vec3(0.55, 0.10, 0.05);  // light that comes through the skin round a fold
const vec3 SEEP = vec3(0.14, 0.07, 0.06);  // of the key, into its shadow on skin
const vec3 WRAP = vec3(0.30, 0.14, 0.10);

out vec4 diffuse;  // light that has passed the colour once; what is mirrored

float sixteenth(float x) { x *= x; x *= x; x *= x; return x * x; }

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 at = texelFetch(position, here, 0);
    vec4 facing = texelFetch(bent, here, 0);
    vec4 paint = texelFetch(colour, here, 0);
    vec3 n = facing.xyz, eye = normalize(-at.xyz);
    float is_skin = float(at.w == SKIN), is_eye = float(at.w == EYES);
    vec3 wrap = WRAP * is_skin;
    float around = texture(open, gl_FragCoord.xy / size).r;
    vec3 reached = around + BLEED * is_skin * around * (1.0 - around);
    vec3 light = mix(ground, sky, 0.5 + 0.5 * n.y) * reached;
    vec3 gloss = vec3(0.0);
    float key = lit(at.xyz, n);
    for (int k = 0; k < 3; ++k) {
        float toward = dot(n, towards[k]);
        vec3 reach = k == 0 ? mix(vec3(key), vec3(1.0), SEEP * is_skin) : vec3(1.0);
        light += power[k] * reach * (0.35 + 0.65 * reached) * max((toward + wrap) / ((1.0 + wrap) * (1.0 + wrap)), 0.0);
        float half_way = max(dot(n, normalize(towards[k] + eye)), 0.0);
        float wide = sixteenth(half_way), narrow = sixteenth(sixteenth(half_way));
        gloss += power[k] * reach * step(0.0, toward) * (mix(0.16 * wide, 1.8 * narrow, is_eye));
    }
    float grazing = 1.0 - max(dot(n, eye), 0.0);
    gloss *= paint.a * around * (1.0 + 2.0 * grazing * grazing * grazing);
    diffuse = vec4(light * paint.rgb, dot(gloss, vec3(1.0 / 3.0)));
}
