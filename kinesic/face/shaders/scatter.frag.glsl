// Light that spreads under the skin (thesis 5.1 and 5.2), along one axis: a trilateral filter by Wendland's function,
// spent only where occlusion says that the surface curves.
uniform sampler2D position;
uniform sampler2D bent;
uniform sampler2D diffuse;
uniform sampler2D open;
uniform vec2 size;
uniform vec2 axis;        // [pixels] of a step
uniform float pace;       // [m] of a step
uniform float width;      // [m] that red light spreads
uniform float threshold;  // of openness, over which a pixel is left as it is

const int STEPS = 4;
const float SKIN = 1.0;
const vec3 SHARE = vec3(1.0, 0.55, 0.4);  // of the width, of each colour

out vec4 scattered;

vec3 wendland(vec3 t) {
    vec3 u = max(1.0 - t, 0.0);
    u *= u;
    return u * u * (4.0 * t + 1.0);
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    scattered = texelFetch(diffuse, here, 0);
    vec4 at = texelFetch(position, here, 0);
    if (at.w == SKIN && texture(open, gl_FragCoord.xy / size).r <= threshold) {
        vec3 n = texelFetch(bent, here, 0).xyz, sum = scattered.rgb, weights = vec3(1.0);
        for (int k = -STEPS; k <= STEPS; ++k) {
            if (k == 0) continue;
            ivec2 there = here + ivec2(round(float(k) * axis));
            vec4 other = texelFetch(position, there, 0);
            float facing = max(dot(n, texelFetch(bent, there, 0).xyz), 0.0) * float(other.w == SKIN);
            vec3 weight = wendland(abs(float(k)) * pace / (width * SHARE)) * wendland(vec3(abs(other.z - at.z) / width))
                        * facing * facing * facing;
            sum += weight * texelFetch(diffuse, there, 0).rgb;
            weights += weight;
        }
        scattered.rgb = sum / weights;
    }
}
