// The G-buffer of what is not skin: eyes, teeth, tongue and lashes, with their colours.
uniform sampler2D iris;  // painted round the axis of an eye

in vec3 facing;
in vec4 placed;
flat in float kind;
in float detail;

const float IRIS = 0.8;       // half the width of the painting, in radii of the eye
const float STRANDS = 60.0;   // lashes per unit of the chart
const vec3 GUMS = vec3(0.11, 0.028, 0.025);

layout(location = 0) out vec4 form;
layout(location = 1) out vec4 place;  // square root of the linear colour; how much it shines

void main() {
    vec4 paint = vec4(0.02, 0.014, 0.012, 0.05);
    if (kind == LASHES) {
        float across = abs(fract(placed.x * STRANDS + 0.35 * detail) - 0.5);
        float length = placed.y > 0.0 ? 1.0 : 0.6;
        float width = 0.45 * (1.0 - detail / length);
        if (across > width || width < 0.2 * min(fwidth(placed.x * STRANDS), 1.0)) discard;  // no dots where it is thin
    } else if (kind == EYES) {
        float lid = 1.0 - 0.55 * smoothstep(0.05, 0.55, placed.y) - 0.25 * smoothstep(0.35, 0.75, abs(placed.x));
        paint = vec4(textureLod(iris, placed.xy / IRIS * 0.5 + 0.5, 0.0).rgb * lid, 1.0);
    } else {  // it is dark in the mouth
        float light = kind == TEETH ? smoothstep(0.0, 0.42, placed.z) : smoothstep(-0.8, 0.5, placed.z);
        vec3 colour = kind == TEETH ? vec3(0.68, 0.63, 0.55) : vec3(0.42, 0.12, 0.11);
        paint = vec4(mix(GUMS, colour, light), (kind == TEETH ? 0.8 : 0.5) * light);
    }
    form = vec4(normalize(facing), -1.0 / gl_FragCoord.w - APART * kind);
    place = vec4(sqrt(paint.rgb), paint.a);
}
