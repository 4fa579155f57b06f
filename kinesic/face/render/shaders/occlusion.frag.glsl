// Ambient occlusion (thesis chapter 3): the fraction of ambient light at each pixel, sampled in the G-buffer.
// Exact: along all directions. Separable: along two perpendicular directions that vary from pixel to pixel.
// The pattern has WIDE x TALL pixels; DIRECTIONS are sampled in both senses, with STEPS samples each.
uniform sampler2D position;
uniform sampler2D normal;
uniform sampler2D pattern;  // cosine and sine of the first direction, interleaved over the screen
uniform vec2 turn;          // cosine and sine of the angle between directions
uniform float stride;       // [pixels] step length
uniform vec2 pixel;         // size in texture coordinates
uniform float radius;       // [m] range of occluders
uniform float strength;
uniform float all;          // sum of weights along one direction

const float APART = 8.0;      // [m] depth offset per part, which separates parts in the blur
const float BIAS = 0.10;      // sine of the elevation below which a surface cannot occlude itself

in vec2 uv;

out vec4 found;  // openness 0..1; depth [m] minus the part's offset, 0 on the background; x and y of the normal

// Weight of an occluder at a distance relative to the radius.
float falloff(float t) {
#if FALLOFF == 1  // Gaussian with the half width of Wendland's function
    return t < 1.0 ? exp(-6.8587 * t * t) : 0.0;
#else  // Wendland
    float u = max(1.0 - t, 0.0);
    u *= u;
    return u * u * (4.0 * t + 1.0);
#endif
}

// Occlusion of a pixel by a sample, 0..1, relative to the tangent plane, so that slopes do not darken themselves. The plain
// depth test (3.3.1) compares distances from the camera instead.
float occluded(vec3 p, vec3 n, vec4 at) {
#if ESTIMATOR == 4  // plain depth test
    return 0.5 * float(at.w > 0.0 && at.z > p.z);
#else
    vec3 way = at.xyz - p;
    float away = max(length(way), 1e-7), height = dot(n, way);
    float near = float(at.w > 0.0) * falloff(away / radius);
#if ESTIMATOR == 1  // Crytek's test, in front of the tangent plane or behind
    return 0.5 * step(BIAS, height / away) * near;
#elif ESTIMATOR == 2  // volumetric obscurance: filled fraction of the line through the sphere
    return clamp(1.5 * (height / radius - 0.2 * BIAS), 0.0, 1.0) * sqrt(near);
#else  // angular, and horizon, which uses the maximum
    return 2.2 * max(height / away - BIAS, 0.0) * near;
#endif
#endif
}

void main() {
    vec4 at = textureLod(position, uv, 0.0);
    vec3 p = at.xyz;
    vec3 n = textureLod(normal, uv, 0.0).xyz;
    vec2 way = texelFetch(pattern, ivec2(gl_FragCoord.xy) % ivec2(WIDE, TALL), 0).rg;
    float sum = 0.0;
    for (int direction = 0; direction < DIRECTIONS; ++direction) {
        for (int sign = -1; sign <= 1; sign += 2) {
            float blocked = 0.0;
            for (int k = 1; k <= STEPS; ++k) {
                vec2 there = uv + way * (float(sign * k) * stride) * pixel;
                float taken = occluded(p, n, textureLod(position, there, 0.0));
#if ESTIMATOR == 3
                blocked = max(blocked, 0.4 * taken);
#else
                blocked += taken * float(k) / all;  // the width of a ring is proportional to its distance
#endif
            }
            sum += blocked;
        }
        way = vec2(turn.x * way.x - turn.y * way.y, turn.y * way.x + turn.x * way.y);
    }
    float open = clamp(1.0 - strength * sum / float(2 * DIRECTIONS), 0.0, 1.0);
    found = at.w > 0.0 ? vec4(open, at.z - APART * at.w, n.xy) : vec4(1.0, vec3(0.0));
}
