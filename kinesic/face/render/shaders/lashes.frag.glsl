// Lashes over the picture, with analytic coverage per pixel to avoid aliasing.
in vec4 placed;
flat in float kind;
in float detail;  // position along the lash, 1 at the tip

const float STRANDS = 60.0;  // strands per unit of the chart
const vec3 COLOUR = vec3(0.02, 0.014, 0.012);

out vec4 covered;

void main() {
    bool upper = placed.y > 0.0;
    float along = placed.x * STRANDS + 0.5 * detail, pixel = max(fwidth(along), 1e-4);
    float uneven = fract(52.9829189 * fract(floor(along) * 0.06711056));  // varies the length of strands
    float left = max(1.0 - detail / ((upper ? 1.0 : 0.7) * (0.6 + 0.4 * uneven)), 0.0);
    float half_width = (upper ? 0.5 : 0.35) * left * sqrt(left);
    float strand = clamp((half_width - abs(fract(along) - 0.5)) / pixel + 0.5, 0.0, 1.0);
    covered = vec4(shown(COLOUR).rgb, (upper ? 0.95 : 0.55) * mix(strand, 2.0 * half_width, smoothstep(0.4, 1.0, pixel)));
}
