// Received fraction of key light by percentage-closer soft shadows (R. Fernando, 2005; thesis 12.1). Blockers are searched
// first; the farther they are from the pixel, the wider is the depth comparison. BLOCKERS and TAPS are the numbers of
// samples along a side of the search and of the comparison. BILINEAR samples mix the comparisons of four pixels of the map.
uniform sampler2D position;
uniform sampler2D normal;
uniform sampler2D open;    // openness to ambient light
uniform sampler2D depths;  // depths of opaque layers seen from the lamp
uniform mat4 lamp;         // transform to the lamp's clip space
uniform float deep;        // [m] half depth of that space
uniform float away;        // [m] distance of the lamp from the head's centre
uniform float wide;        // width of the lamp relative to the map
uniform float nearest;     // minimum width of the comparison relative to the map
#if COLOURED
uniform sampler2D tint_depths;  // depths of translucent layers
uniform sampler2D tints;
#endif

const float LIFT = 0.002;    // [m] offset from the surface against self shadowing
const float BIAS = 0.003;
const float FURTHEST = 0.12; // maximum distance of a blocker relative to the lamp's distance

in vec2 uv;

out vec4 reached;  // received fractions of key light and of ambient light

// Point of an n x n grid in a unit square around 0, rotated so that no two points align with an axis.
vec2 point(int i, int j, int n) {
    vec2 cell = (vec2(i, j) + 0.5) / float(n) - 0.5;
    return cell + vec2(-cell.y, cell.x) / float(n);
}

// Distance from the lamp [m].
float metres(float depth) { return away + (2.0 * depth - 1.0) * deep; }

// Whether a point of the map lets light pass to a depth, 0..1.
float passes(vec2 at, float depth) {
#if BILINEAR
    vec2 place = at * vec2(textureSize(depths, 0)) - 0.5, part = fract(place);
    ivec2 first = ivec2(floor(place)), last = textureSize(depths, 0) - 1;
    ivec2 low = clamp(first, ivec2(0), last), high = clamp(first + 1, ivec2(0), last);
    vec4 others = vec4(texelFetch(depths, low, 0).r, texelFetch(depths, ivec2(high.x, low.y), 0).r,
                       texelFetch(depths, ivec2(low.x, high.y), 0).r, texelFetch(depths, high, 0).r);
    vec4 lit = step(vec4(depth), others);
    vec2 mixed = mix(lit.xz, lit.yw, part.x);
    return mix(mixed.x, mixed.y, part.y);
#else
    return step(depth, textureLod(depths, at, 0.0).r);
#endif
}

void main() {
    vec4 seen = textureLod(position, uv, 0.0);
    vec3 n = textureLod(normal, uv, 0.0).xyz;
    vec3 at = (lamp * vec4(seen.xyz + LIFT * n, 1.0)).xyz * 0.5 + 0.5;
    float depth = at.z - BIAS, blocked = 0.0, found = 0.0;
    for (int j = 0; j < BLOCKERS; ++j)
        for (int i = 0; i < BLOCKERS; ++i) {
            float other = textureLod(depths, at.xy + wide * FURTHEST * point(i, j, BLOCKERS), 0.0).r;
            blocked += other < depth ? other : 0.0;
            found += float(other < depth);
        }
    float from_lamp = metres(blocked / max(found, 1.0));
    float penumbra = max((metres(depth) - from_lamp) / from_lamp * wide, nearest);  // 12.1.2
    float lit = 0.0;
    int compared = found > 0.0 ? TAPS : 0;  // allows drivers to skip the loop
    for (int j = 0; j < compared; ++j)
        for (int i = 0; i < TAPS; ++i)
            lit += passes(at.xy + penumbra * point(i, j, TAPS), depth);
    reached = vec4(vec3(found > 0.0 ? lit / float(TAPS * TAPS) : 1.0), textureLod(open, uv, 0.0).r);
#if COLOURED
    vec3 through = vec3(0.0);
    for (int j = 0; j < TAPS; ++j)
        for (int i = 0; i < TAPS; ++i) {
            vec2 there = at.xy + 0.5 * wide * FURTHEST * point(i, j, TAPS);
            through += textureLod(tint_depths, there, 0.0).r < depth ? textureLod(tints, there, 0.0).rgb : vec3(1.0);
        }
    reached.rgb *= through / float(TAPS * TAPS);
#endif
}
