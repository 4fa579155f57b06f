// Lashes over the picture, with analytic coverage per pixel to avoid aliasing.
in vec4 placed;
flat in float kind;
in float detail;  // position along the lash, 1 at the tip

const float STRANDS = 105.0;  // strands per unit of the chart
const float EYE_MIDDLE = 0.45;  // chart position where lashes point straight ahead
const float FAN = 15.0;  // [strands per unit of the chart] by which tips fan out
const float CLUMP = 0.9; // [strands] by which the tips of two neighbours approach
const vec3 COLOUR = vec3(0.02, 0.014, 0.012);

out vec4 covered;

void main() {
    bool upper = placed.y > 0.0;
    float outer = abs(placed.x), straight = outer * STRANDS - FAN * (outer - EYE_MIDDLE) * detail * detail;
    float along = straight + CLUMP * (mod(floor(straight), 2.0) - 0.5) * detail, pixel = max(fwidth(straight), 1e-4);
    float uneven = fract(52.9829189 * fract(floor(straight) * 0.06711056));  // varies the length of strands
    float left = max(1.0 - detail / ((upper ? 0.9 : 0.6) * (0.6 + 0.4 * uneven)), 0.0);
    float half_width = (upper ? 0.5 : 0.3) * left;
    vec2 ends = clamp((vec2(half_width, -half_width) - abs(fract(along) - 0.5)) / pixel + 0.5, 0.0, 1.0);
    float strand = ends.x - ends.y;  // covered fraction of the pixel, 0 beyond the tip
    covered = vec4(shown(COLOUR).rgb, (upper ? 0.95 : 0.55) * mix(strand, 2.0 * half_width, smoothstep(0.4, 1.0, pixel)));
}
