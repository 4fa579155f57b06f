// How much of the key light reaches each pixel: percentage-closer soft shadows (R. Fernando, 2005; thesis 12.1). What is
// in the way is looked for first; the further in front it stands, the wider is the region that is compared. BLOCKERS is
// how many samples along a side the first has, TAPS the second.
uniform sampler2D position;
uniform sampler2D normal;
uniform sampler2D open;    // to the light around
uniform sampler2D depths;  // of what lets no light through, as the lamp sees it
uniform mat4 lamp;         // to its clip space
uniform float deep;        // [m] half the depth of that space
uniform float away;        // [m] from the lamp to the middle of the head
uniform float wide;        // [share of the map] that the lamp is
uniform float nearest;     // [share of the map] that is always compared
#if COLOURED
uniform sampler2D tint_depths;  // of what lets coloured light through
uniform sampler2D tints;
#endif

const float LIFT = 0.002;    // [m] off the surface, so that it does not shade itself
const float BIAS = 0.003;
const float FURTHEST = 0.12; // [share of the lamp's distance] that something in the way may be from a pixel

in vec2 uv;

out vec4 reached;  // how much of it; how much of the light around

// Points of a grid of n x n over a square about 0 of side 1, turned so that no two are in line along an axis.
vec2 point(int i, int j, int n) {
    vec2 cell = (vec2(i, j) + 0.5) / float(n) - 0.5;
    return cell + vec2(-cell.y, cell.x) / float(n);
}

// Distance from the lamp [m].
float metres(float depth) { return away + (2.0 * depth - 1.0) * deep; }

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
    int compared = found > 0.0 ? TAPS : 0;  // a loop that all leave is skipped
    for (int j = 0; j < compared; ++j)
        for (int i = 0; i < TAPS; ++i)
            lit += step(depth, textureLod(depths, at.xy + penumbra * point(i, j, TAPS), 0.0).r);
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
