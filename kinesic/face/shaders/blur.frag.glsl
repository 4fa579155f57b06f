// Takes the pattern out of the occlusion, along one axis, without crossing edges.
uniform sampler2D position;
uniform sampler2D normal;
uniform sampler2D noisy;
uniform vec2 axis;
uniform int coarse;
uniform int side;  // pixels of the pattern

const float EDGE = 0.006;  // [m]

out float open;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy), way = ivec2(axis);
    vec4 at = texelFetch(position, here * coarse, 0);
    vec3 n = texelFetch(normal, here * coarse, 0).xyz;
    float sum = 0.0, weights = 1e-6;
    int reach = at.w > 0.0 ? side / 2 : -1;
    for (int k = -reach; k <= reach; ++k) {
        ivec2 there = here + k * way;
        vec4 other = texelFetch(position, there * coarse, 0);
        float weight = abs(k) == reach ? 0.5 : 1.0;  // together as wide as the pattern
        weight *= max(1.0 - abs(other.z - at.z) / EDGE, 0.0) * max(dot(n, texelFetch(normal, there * coarse, 0).xyz), 0.0)
                * float(other.w == at.w);
        sum += weight * texelFetch(noisy, there, 0).r;
        weights += weight;
    }
    open = at.w > 0.0 ? sum / weights : 1.0;
}
