// Subsurface scattering along one axis (thesis 5.1 and 5.2): the trilateral filter 5.1.5, whose weights are Wendland's of
// place and of depth, and the cosine between normals. It has STEPS samples on each side, fewer at the lower LEVELS. The LAST
// of two axes writes the picture.
uniform sampler2D bent;  // form with bent normals
uniform sampler2D diffuse;
uniform vec2 axis;    // step in texture coordinates
uniform float width;  // [m] spread of red light
#if LAST || LEVELS > 1
uniform sampler2D colour;  // square root of the colour; scattering level 0..1
#endif

const vec3 SHARE = vec3(1.0, 0.55, 0.4);  // spread of each colour relative to red

in vec2 uv;

out vec4 scattered;

vec3 wendland(vec3 t) {
    vec3 u = max(1.0 - t, 0.0);
    u *= u;
    return u * u * (4.0 * t + 1.0);
}

void main() {
    scattered = textureLod(diffuse, uv, 0.0);
    vec4 own = textureLod(bent, uv, 0.0);
    vec3 sum = scattered.rgb, weights = vec3(1.0);
#if LEVELS > 1
    int taken = int(ceil(float(STEPS) * textureLod(colour, uv, 0.0).a - 0.01));
#else
    const int taken = STEPS;
#endif
    for (int k = 1; k <= taken; ++k) {
        vec3 near = wendland(float(k) / (float(STEPS) * SHARE));
        for (float side = -1.0; side <= 1.0; side += 2.0) {
            vec2 there = uv + side * float(k) * axis;
            vec4 other = textureLod(bent, there, 0.0);  // other parts have a large depth offset
            float facing = max(dot(own.xyz, other.xyz), 0.0);
            vec3 weight = near * (wendland(vec3(abs(other.w - own.w) / width)).x * facing);
            sum += weight * textureLod(diffuse, there, 0.0).rgb;
            weights += weight;
        }
    }
    scattered.rgb = sum / weights;
#if LAST
    scattered = composed(scattered, textureLod(colour, uv, 0.0).rgb);
#endif
}
