// Removes the pattern of SIDE pixels from the occlusion along one axis, without crossing edges.
uniform sampler2D noisy;
uniform vec2 axis;  // step in texture coordinates

const float EDGE = 0.006;  // [m]
const int REACH = SIDE / 2;

in vec2 uv;

out vec4 smoothed;  // packed as in the occlusion pass

float up(vec2 n) { return sqrt(max(1.0 - dot(n, n), 0.0)); }

void main() {
    vec4 at = textureLod(noisy, uv, 0.0);
    vec3 n = vec3(at.zw, up(at.zw));
    float sum = 0.0, weights = 1e-6;
    for (int k = -REACH; k <= REACH; ++k) {
        vec4 other = textureLod(noisy, uv + float(k) * axis, 0.0);
        float weight = SIDE % 2 == 0 && abs(k) == REACH ? 0.5 : 1.0;  // total width equals that of the pattern
        weight *= max(1.0 - abs(other.y - at.y) / EDGE, 0.0) * max(dot(n, vec3(other.zw, up(other.zw))), 0.0);
        sum += weight * other.x;
        weights += weight;
    }
    smoothed = vec4(at.y < 0.0 ? sum / weights : 1.0, at.yzw);
}
