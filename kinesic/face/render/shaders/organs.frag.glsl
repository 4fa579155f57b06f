// The G-buffer of what is not skin: eyes, teeth and tongue, with their colours.
uniform sampler2D iris;  // painted round the axis of an eye
uniform mat4 view;
uniform mat3 balls[2];   // how the left and the right eyeball stand in the camera's frame: forward, left, up

in vec3 facing;
in vec4 placed;
flat in float kind;
in float detail;  // which of the eyes

const float IRIS = 0.8;    // half the width of the painting, in radii of the eye
const float CORNEA = 0.2742;  // square of the angle at which it ends, and how far it stands out, as in eyeball.py
const float BULGE = 0.05;
const float SUNKEN = 0.12; // how far the iris lies behind it, as it is refracted
const float DAMP = 0.2;    // how much the white of the eye shines beside the cornea
const vec3 GUMS = vec3(0.11, 0.028, 0.025);

layout(location = 0) out vec4 form;
layout(location = 1) out vec4 place;  // square root of the linear colour; how much it shines

// The colour of an eye; its normal is bent by the cornea.
vec4 eye(mat3 ball, inout vec3 n) {
    vec3 own = n * ball, head = n * mat3(view), seen = vec3(0.0, 0.0, 1.0) * ball;
    float short_of = 1.0 - own.x, inside = max(1.0 - short_of * (2.0 + short_of / 3.0) / CORNEA, 0.0);
    n = normalize(n + 4.0 * BULGE / CORNEA * inside * (n - ball[0] * own.x));
    float lid = 1.0 - 0.45 * smoothstep(0.05, 0.5, head.z) - 0.25 * smoothstep(0.4, 0.8, abs(head.y));
    return vec4(textureLod(iris, (own.yz - SUNKEN * inside * seen.yz) / IRIS * 0.5 + 0.5, 0.0).rgb * lid, mix(DAMP, 1.0, inside));
}

void main() {
    vec4 paint;
    vec3 n = normalize(facing);
    if (kind == EYES) {
        paint = eye(detail > 0.5 ? balls[1] : balls[0], n);
    } else {  // it is dark in the mouth
        float light = kind == TEETH ? smoothstep(0.0, 0.42, placed.z) : smoothstep(-0.8, 0.5, placed.z);
        vec3 colour = kind == TEETH ? vec3(0.68, 0.63, 0.55) : vec3(0.42, 0.12, 0.11);
        paint = vec4(mix(GUMS, colour, light), (kind == TEETH ? 0.8 : 0.5) * light);
    }
    form = vec4(n, -1.0 / gl_FragCoord.w - APART * kind);
    place = vec4(sqrt(paint.rgb), paint.a);
}
