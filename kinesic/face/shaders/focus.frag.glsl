// Depth of field (thesis 12.1): each pixel gathers from a region as wide as its circle of confusion.
uniform sampler2D position;
uniform sampler2D picture;
uniform vec2 lens;     // the widest circle's radius, in texture coordinates
uniform float sharp;   // [m] depth that is in focus
uniform float within;  // [m] from there that is sharp, too
uniform int taps;

const float BEHIND = 4.0;     // [m] the backdrop
const float TURN = 2.399963;  // golden angle

in vec2 uv;

out vec4 focused;

// 12.1.1, as a share of the widest; and the depth.
vec2 circle(vec2 there) {
    vec4 at = textureLod(position, there, 0.0);
    float depth = at.w > 0.0 ? -at.z : BEHIND;
    return vec2(max(abs(depth - sharp) - within, 0.0) / depth, depth);
}

void main() {
    vec2 own = circle(uv), way = vec2(1.0, 0.0);
    vec4 sum = vec4(textureLod(picture, uv, 0.0).rgb, 1.0);
    mat2 turn = mat2(cos(TURN), sin(TURN), -sin(TURN), cos(TURN));
    int gathered = own.x > 0.0 ? taps : 0;
    for (int k = 1; k <= gathered; ++k) {
        float share = sqrt(float(k) / float(taps));
        vec2 there = uv + share * own.x * lens * way, other = circle(there);
        float spreads = other.y > own.y ? 1.0 : clamp(8.0 * (other.x / own.x - share) + 1.0, 0.0, 1.0);  // what is sharp stays so
        sum += spreads * vec4(textureLod(picture, there, 0.0).rgb, 1.0);
        way = turn * way;
    }
    focused = vec4(sum.rgb / sum.w, 1.0);
}
