// Light that spreads under the skin (thesis 5.1 and 5.2), along one axis: a trilateral filter by Wendland's function.
uniform sampler2D position;
uniform sampler2D bent;
uniform sampler2D diffuse;
uniform vec2 axis;    // of a step, in texture coordinates
uniform float pace;   // [m] of a step
uniform float width;  // [m] that red light spreads
uniform int steps;    // on each side

const float SKIN = 1.0;
const vec3 SHARE = vec3(1.0, 0.55, 0.4);  // of the width, of each colour

in vec2 uv;

out vec4 scattered;

vec3 wendland(vec3 t) {
    vec3 u = max(1.0 - t, 0.0);
    u *= u;
    return u * u * (4.0 * t + 1.0);
}

void main() {
    scattered = textureLod(diffuse, uv, 0.0);
    float depth = textureLod(position, uv, 0.0).z;
    vec3 n = textureLod(bent, uv, 0.0).xyz, sum = scattered.rgb, weights = vec3(1.0);
    for (int k = 1; k <= steps; ++k) {
        vec3 near = wendland(float(k) * pace / (width * SHARE));
        for (float side = -1.0; side <= 1.0; side += 2.0) {
            vec2 there = uv + side * float(k) * axis;
            vec4 other = textureLod(position, there, 0.0);
            float facing = other.w == SKIN ? max(dot(n, textureLod(bent, there, 0.0).xyz), 0.0) : 0.0;
            vec3 weight = near * (wendland(vec3(abs(other.z - depth) / width)).x * facing * facing * facing);
            sum += weight * textureLod(diffuse, there, 0.0).rgb;
            weights += weight;
        }
    }
    scattered.rgb = sum / weights;
}
